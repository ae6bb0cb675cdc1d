// Result <-> JSON (format saltus-result/1), and the trajectory as CSV.
#pragma once

#include <filesystem>
#include <string>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

/// Numbers as shortest round trip, non-finite ones as null.
[[nodiscard]] std::string to_json(const result::Result& result);
/// Reads a stored result; errors name the file, the position or the JSON path, and what was expected.
[[nodiscard]] Expected<result::Result> read_result(const std::filesystem::path& file);
[[nodiscard]] Expected<result::Result> parse_result(const std::string& text, const std::string& file);
/// Header t,<states>,<controls>,alpha(<name>)…,mode(<name>)…; fields quoted by RFC 4180.
[[nodiscard]] std::string to_csv(const result::Result& result);

}  // namespace saltus::io
