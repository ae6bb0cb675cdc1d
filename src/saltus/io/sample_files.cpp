#include "saltus/io/sample_files.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "saltus/io/json/json_result.hpp"
#include "saltus/io/separated_line_internal.hpp"

namespace saltus::io {
namespace {

/// Reads line by line; the first mistake ends it.
class ColumnReader {
 public:
  ColumnReader(const std::string& file, const std::string& second) : second_(second) { columns_.file = file; }

  Expected<Columns> read(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    while (!text.empty() && !error_) {
      const auto end = std::min(text.find('\n'), text.size());
      auto line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      ++line_;
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line.find_first_not_of(" \t") == std::string_view::npos || line.starts_with('#')) continue;
      row(separated_fields(line));
    }
    if (error_) return tl::unexpected(*error_);
    return std::move(columns_);
  }

 private:
  void fail(std::string message, std::string remedy) {
    error_ = Error{ErrorCode::parse_failure, std::move(message), std::move(remedy), {columns_.file, line_, 1}, {}};
  }

  void row(const std::vector<std::string_view>& fields) {
    const bool begins = !width_;
    if (begins) width_ = fields.size();
    if (begins && !separated_number(fields.front()) &&
        std::none_of(fields.begin(), fields.end(), [](auto field) { return separated_number(field).has_value(); })) {
      header(fields);
      return;
    }
    if (begins && fields.size() != 2) {
      fail(fmt::format("expected two columns, found {}", fields.size()),
           "write two numbers a line, e.g. 0.5,1.25, or a first line with the names of the columns");
      return;
    }
    if (fields.size() != *width_) {
      fail(fmt::format("expected {} columns as before, found {}", *width_, fields.size()), "complete the line");
      return;
    }
    const auto first = value(fields[0]), second = value(fields[taken_]);
    if (!first || !second) return;
    columns_.first.push_back(*first);
    columns_.second.push_back(*second);
    columns_.lines.push_back(line_);
  }

  void header(const std::vector<std::string_view>& names) {
    const auto named = std::find(names.begin() + 1, names.end(), second_);
    if (named != names.end()) {
      taken_ = static_cast<std::size_t>(named - names.begin());
    } else if (names.size() != 2) {
      std::vector<std::string> known(names.begin() + 1, names.end());
      fail(fmt::format("expected a column '{}' or two columns, found {}", second_, names.size()),
           known.empty() ? "separate the columns by commas" : suggest(second_, known));
    }
  }

  std::optional<double> value(std::string_view field) {
    auto number = separated_number(field);
    if (!number) {
      constexpr std::size_t shown = 40;
      fail(fmt::format("expected a number, found '{}'", field.substr(0, shown)),
           "columns are separated by commas, decimals by a point");
    }
    return number;
  }

  const std::string& second_;
  Columns columns_;
  std::optional<std::size_t> width_;
  std::size_t taken_ = 1;
  int line_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Expected<Columns> parse_columns(std::string_view text, const std::string& file, const std::string& second) {
  return ColumnReader(file, second).read(text);
}

Error located(const model::PointMistake& mistake, const Columns& columns) {
  const int line = mistake.point && *mistake.point < columns.lines.size() ? columns.lines[*mistake.point] : 0;
  return {ErrorCode::invalid_model, mistake.message, mistake.remedy, {columns.file, line, line > 0 ? 1 : 0}, {}};
}

Expected<Columns> parse_control(const std::string& text, const std::string& file, const std::string& control) {
  const auto result = parse_result(text, file);
  if (!result) return tl::unexpected(result.error());
  const auto found = std::find(result->controls.begin(), result->controls.end(), control);
  if (found == result->controls.end()) {
    return tl::unexpected(
        Error{ErrorCode::unknown_name,
              fmt::format("the result has no control '{}'", control),
              result->controls.empty() ? "its model has no controls" : suggest(control, result->controls),
              {file, 0, 0},
              {}});
  }
  const auto index = static_cast<std::size_t>(found - result->controls.begin());
  Columns columns;
  columns.file = file;
  if (result->optimization && !result->optimization->u.empty()) {
    const auto& grid = result->optimization->grid;
    columns.first.assign(grid.begin(), grid.end() - 1);
    for (const auto& row : result->optimization->u) columns.second.push_back(row[index]);
    return columns;
  }
  for (std::size_t i = 0; i < result->trajectory.t.size(); ++i) {
    const double t = result->trajectory.t[i], u = result->trajectory.u[i][index];
    if (!columns.first.empty() && columns.first.back() == t) {
      columns.second.back() = u;
      continue;
    }
    columns.first.push_back(t);
    columns.second.push_back(u);
  }
  return columns;
}

}  // namespace saltus::io
