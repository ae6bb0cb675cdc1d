// JSON as text.
#pragma once

#include <cstddef>
#include <string>

#include "saltus/io/json/json_reader_internal.hpp"

namespace saltus::io {

/// Writes one name, one row of a table, one event field per line: small to store and still to be read by people.
[[nodiscard]] std::string laid_out(const Json& json);
/// Appends the same inside something that is indented by so much, without a line's end.
void append_laid_out(const Json& json, std::size_t indent, std::string& text);
/// Writes on one line.
[[nodiscard]] std::string compact(const Json& json);

}  // namespace saltus::io
