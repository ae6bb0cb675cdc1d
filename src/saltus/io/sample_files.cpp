#include "saltus/io/sample_files.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/io/json/json_result.hpp"
#include "saltus/io/separated_line_internal.hpp"
#include "saltus/io/text_encoding_internal.hpp"

namespace saltus::io {
namespace {

/// Whether a field is a number but for the comma in it: "0,5".
bool has_decimal_comma(std::string_view field) {
  const auto comma = field.find(',');
  return comma != std::string_view::npos && separated_number(field.substr(0, comma)) &&
         separated_number(field.substr(comma + 1));
}

/// Reads line by line; the first mistake ends it.
class ColumnReader {
 public:
  ColumnReader(const std::string& file, const std::string& second, ColumnsOf of) : second_(second), of_(of) {
    columns_.file = file;
  }

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
    if (begins &&
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
      fail(fmt::format("expected {} columns as before, found {}", *width_, fields.size()),
           fields.size() < *width_ ? "complete the line"
           : fields.back().empty() ? "end no line with a separator"
                                   : "every line has as many numbers as the first one");
      return;
    }
    const auto first = value(fields[argument_]), second = value(fields[taken_]);
    if (!first || !second) return;
    columns_.first.push_back(*first);
    columns_.second.push_back(*second);
    columns_.lines.push_back(line_);
  }

  void header(const std::vector<std::string_view>& names) {
    if (const auto number = std::find_if(names.begin(), names.end(), has_decimal_comma); number != names.end()) {
      return fail_number(*number);
    }
    constexpr std::array<std::string_view, 4> arguments{"t", "time", "times", "x"};
    const auto known = arguments.end() - (of_ == ColumnsOf::input ? 1 : 0);
    const auto values = std::find(names.begin(), names.end(), second_);
    auto argument = names.begin();
    const auto is_argument = [&](std::string_view name) { return std::find(arguments.begin(), known, name) != known; };
    while (argument != names.end() && (argument == values || !is_argument(*argument))) ++argument;
    const bool has_values = values != names.end(), has_argument = argument != names.end();
    const auto place = [&](auto found) { return static_cast<std::size_t>(found - names.begin()); };
    const bool in_order = names.size() == 2 && of_ == ColumnsOf::table && !has_values && !has_argument;
    if (in_order) return;
    if (names.size() == 2 && (has_values || (has_argument && of_ == ColumnsOf::table))) {
      taken_ = has_values ? place(values) : 1 - place(argument);
      argument_ = 1 - taken_;
    } else if (has_values && (has_argument || of_ == ColumnsOf::table)) {
      taken_ = place(values);
      argument_ = has_argument ? place(argument) : taken_ == 0 ? 1 : 0;
    } else {
      fail_header(names, has_values);
    }
  }

  void fail_header(const std::vector<std::string_view>& names, bool has_values) {
    const std::string wanted = has_values ? "t" : second_;
    const auto message = fmt::format("expected a column '{}', found the column{} '{}'", wanted,
                                     names.size() == 1 ? "" : "s", fmt::join(names, "', '"));
    fail(message, names.size() == 1   ? "separate the columns by commas"
                  : names.size() == 2 ? fmt::format("name the columns t and {}, or leave their names out: then times "
                                                    "stand first",
                                                    second_)
                                      : fmt::format("name the column '{}' in the first line", wanted));
  }

  void fail_number(std::string_view field) {
    constexpr std::size_t shown = 40;
    fail(fmt::format("expected a number, found '{}'", field.substr(0, shown)),
         "columns are separated by commas, decimals by a point");
  }

  std::optional<double> value(std::string_view field) {
    auto number = separated_number(field);
    if (!number) fail_number(field);
    return number;
  }

  const std::string& second_;
  ColumnsOf of_;
  Columns columns_;
  std::optional<std::size_t> width_;
  std::size_t argument_ = 0;
  std::size_t taken_ = 1;
  int line_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Expected<Columns> parse_columns(std::string_view text, const std::string& file, const std::string& second,
                                ColumnsOf of) {
  if (auto readable = check_is_text(text, file, data_remedy); !readable) return tl::unexpected(readable.error());
  return ColumnReader(file, second, of).read(text);
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
