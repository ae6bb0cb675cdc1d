// JSON documents whose long lists stay text until they are read, a piece after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"

namespace saltus::io {

/// No text of JSON has binary values; here such a value is a long list that is still text, a part of its document's.
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t, std::uint64_t,
                                  double, std::allocator, nlohmann::adl_serializer, std::string_view>;

/// Bytes of a list, or of a piece of one, that become a tree: a tree takes ten times the memory of its text.
inline constexpr std::size_t bytes_at_once = std::size_t{1} << 14;

/// Parses a document, which the text must outlive.
/// @return also where the syntax is wrong, anywhere in the text
[[nodiscard]] Expected<Json> parse_document(const std::string& text, const std::string& file);

[[nodiscard]] inline bool is_list(const Json& json) { return json.is_array() || json.is_binary(); }

/// Hands the entries of a list over in pieces, which are lists in a tree; false: no more are wanted.
void for_each_piece(const Json& list, FunctionRef<bool(const Json& piece)> visit);

}  // namespace saltus::io
