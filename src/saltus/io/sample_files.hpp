// Numbers in files beside a model: points of tables, samples of inputs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/cells.hpp"

namespace saltus::io {

/// Holds two columns of a file, with the line each row stands in.
struct Columns {
  std::string file;
  std::vector<double> first, second;
  std::vector<int> lines;
};

/// Reads two columns of numbers, separated by commas, semicolons, tabs or spaces; empty lines and lines that begin with
/// # are skipped. A first line without numbers is a header; with it there may be more columns, of which the first one
/// and the one named `second` are taken (the second one if there are just two). Fails with the file's own line: what is
/// no number, wrong number of columns, no such column.
[[nodiscard]] Expected<Columns> parse_columns(std::string_view text, const std::string& file,
                                              const std::string& second);

/// Returns the mistake that was found in the columns, with the line of its row.
[[nodiscard]] Error located(const model::PointMistake& mistake, const Columns& columns);

/// Reads the piecewise constant control of a stored result: of an optimisation one sample per control interval, else
/// one per row of its trajectory, of rows at one time the last. Fails if there is no such control.
/// @param file  for messages
[[nodiscard]] Expected<Columns> parse_control(const std::string& text, const std::string& file,
                                              const std::string& control);

}  // namespace saltus::io
