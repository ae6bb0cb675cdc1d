#include "saltus/frontend/sweep_page.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "saltus/base/version.hpp"
#include "saltus/report/axis_title.hpp"
#include "saltus/report/page_text.hpp"
#include "sweep_page_script.hpp"
#include "sweep_page_style.hpp"

namespace saltus::frontend {
namespace {

/// Rows that are drawn: all, or of every run as many of its last ones as leave room for all runs.
struct DrawnRows {
  std::vector<std::size_t> rows;
  std::size_t most_of_run = 0;  ///< where some are left out
};

DrawnRows drawn_rows(const std::vector<TableColumn>& table) {
  DrawnRows drawn;
  if (table.empty()) return drawn;
  const auto& runs = std::get<std::vector<double>>(table.front().values);
  std::vector<std::size_t> begins;
  for (std::size_t row = 0; row < runs.size(); ++row) {
    if (row == 0 || runs[row] != runs[row - 1]) begins.push_back(row);
  }
  begins.push_back(runs.size());
  const bool all = runs.size() <= rows_of_page;
  if (!all) drawn.most_of_run = std::max<std::size_t>(1, rows_of_page / (begins.size() - 1));
  for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
    const std::size_t count = begins[k + 1] - begins[k];
    const std::size_t left_out = all ? 0 : count - std::min(count, drawn.most_of_run);
    for (std::size_t row = begins[k] + left_out; row < begins[k + 1]; ++row) {
      drawn.rows.push_back(row);
    }
  }
  return drawn;
}

template <class Value>
std::vector<Value> rows_in(const std::vector<Value>& values, const std::vector<std::size_t>& rows) {
  std::vector<Value> result;
  result.reserve(rows.size());
  for (const std::size_t row : rows) result.push_back(values[row]);
  return result;
}

/// What an axis says of a column: label and unit of the name that it begins with, "x(after)" or "v(0)".
std::string axis_of(const std::string& column, const result::Captions& captions) {
  const auto end = std::min(column.find('('), column.size());
  const auto [unit, label] = caption_of(captions, column.substr(0, end));
  return report::axis_title(label.empty() ? column : label + column.substr(end), unit);
}

std::string data_of(const std::vector<TableColumn>& table, const DrawnRows& drawn, const SweepPage& page) {
  using report::script_json;
  result::OptionRecord columns;
  std::vector<std::string> swept, axes;
  for (std::size_t k = 0; k < table.size(); ++k) {
    if (k > 0 && k <= page.names.size()) swept.push_back(table[k].name);
    axes.push_back(axis_of(table[k].name, page.captions));
    std::visit([&](const auto& values) { columns.emplace_back(table[k].name, rows_in(values, drawn.rows)); },
               table[k].values);
  }
  std::string left_out;
  if (drawn.most_of_run > 0) {
    left_out = fmt::format("The table has {} rows: the last {} of every run are drawn.", rows_of(table.front()),
                           drawn.most_of_run);
  }
  const auto said = script_json({{"swept", swept},
                                 {"names", page.names},
                                 {"command", page.command},
                                 {"grid", page.grid},
                                 {"axes", axes},
                                 {"title", page.title},
                                 {"left_out", left_out},
                                 {"saltus", std::string(version)}});
  return fmt::format(R"({{"columns":{},{})", script_json(columns), std::string_view(said).substr(1));
}

}  // namespace

std::string sweep_page(const std::vector<TableColumn>& table, const SweepPage& page) {
  const DrawnRows drawn = drawn_rows(table);
  const auto title = page.title.empty() ? std::string("Sweep") : report::escape_html(page.title);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  // Nothing may be fetched from anywhere.
  html +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += fmt::format("<title>{} - Saltus</title>\n<style>\n{}{}</style>\n</head>\n<body>\n", title,
                      report::page_style(), embedded::sweep_page_style);
  html += "<noscript><p>The pictures need JavaScript.</p></noscript>\n<main id=\"report\"></main>\n";
  html += fmt::format(
      "<script type=\"application/json\" id=\"sweep\">{}</script>\n<script>\n{}</script>\n</body>\n</html>\n",
      data_of(table, drawn, page), embedded::sweep_page_script);
  return html;
}

}  // namespace saltus::frontend
