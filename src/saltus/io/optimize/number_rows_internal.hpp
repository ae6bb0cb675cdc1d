// Rows of numbers in a file beside a model: references of least squares.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::io {

struct NumberRows {
  std::vector<std::vector<double>> rows;
  std::vector<SourceLocation> places;  ///< of the rows
};

/// Reads rows of as many numbers each, separated by commas, semicolons, tabs or spaces; empty lines and lines that
/// begin with # are skipped, as is a first line without numbers. Fails with the file's own line: what is no finite
/// number, a row of another length, no rows at all.
/// @param columns  numbers of every row, >= 1
/// @param what  "a row has one number per expression"
[[nodiscard]] Expected<NumberRows> parse_rows(std::string_view text, const std::string& file, std::size_t columns,
                                              const std::string& what);

}  // namespace saltus::io
