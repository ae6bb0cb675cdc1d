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

/// Says what the two columns are: samples of an input over time, or points of a table over anything.
enum class ColumnsOf { input, table };

/// Reads two columns of numbers, separated by commas, semicolons, tabs or spaces; empty lines and lines that begin with
/// # are skipped. A first line without numbers is a header, whose names count: `second` is the column of the values,
/// t, time or times that of the times (of a table x, too), in any order, and others are skipped. Of two columns one
/// name is enough, of an input that of the values; columns of a table that have other names are x and y in this order.
/// Fails with the file's own line: what is no number, wrong number of columns, no such column.
[[nodiscard]] Expected<Columns> parse_columns(std::string_view text, const std::string& file, const std::string& second,
                                              ColumnsOf of);

/// Returns the mistake that was found in the columns, with the line of its row.
[[nodiscard]] Error located(const model::PointMistake& mistake, const Columns& columns);

/// Reads the piecewise constant control of a stored result: of an optimisation one sample per control interval, else
/// one per row of its trajectory, of rows at one time the last. Fails if there is no such control.
/// @param file  for messages
[[nodiscard]] Expected<Columns> parse_control(const std::string& text, const std::string& file,
                                              const std::string& control);

}  // namespace saltus::io
