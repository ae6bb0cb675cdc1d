#include "saltus/cli/sweep/page.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sweep_page_script.hpp"

namespace saltus::cli {
namespace {

constexpr std::string_view style = R"(
:root{color-scheme:light dark;--line:#8888;--text:CanvasText}
body{font:16px/1.4 system-ui,sans-serif;margin:1.5rem auto;max-width:60rem;padding:0 1rem;background:Canvas;color:var(--text)}
h1{font-size:1.4rem}h2{font-size:1rem;margin:1rem 0 .2rem}svg{width:100%;height:auto;font-size:12px}svg text{fill:var(--text)}
.frame{fill:none;stroke:var(--line)}.run{cursor:pointer}.run:hover{stroke:var(--text)}select{font:inherit}label{margin-right:1rem}
#run{position:sticky;bottom:0;background:Canvas;border-top:1px solid var(--line);padding:.5rem 0}code{user-select:all;word-break:break-all}
)";

/// A text inside a script element: what would end the element is written as escapes.
std::string quoted_json(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == '<' || c == '>' || c == '&') {
      json += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      json += c;
    }
  }
  return json + '"';
}

std::string json_of(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }
std::string json_of(const std::string& value) { return quoted_json(value); }

template <class Values>
std::string list_of(const Values& values, std::size_t most) {
  std::string list = "[";
  for (std::size_t i = 0; i < std::min(values.size(), most); ++i) list += (i > 0 ? "," : "") + json_of(values[i]);
  return list + "]";
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) html += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return html;
}

std::string data_of(const std::vector<TableColumn>& table, const SweepPage& page) {
  std::string columns;
  std::vector<std::string> swept;
  for (std::size_t k = 0; k < table.size(); ++k) {
    if (k > 0 && k <= page.names.size()) swept.push_back(table[k].name);
    columns +=
        fmt::format("{}{}:{}", k > 0 ? "," : "", quoted_json(table[k].name),
                    std::visit([](const auto& values) { return list_of(values, rows_of_page); }, table[k].values));
  }
  return fmt::format(R"({{"columns":{{{}}},"swept":{},"names":{},"command":{},"grid":{}}})", columns,
                     list_of(swept, swept.size()), list_of(page.names, page.names.size()), quoted_json(page.command),
                     page.grid);
}

}  // namespace

std::string sweep_page(const std::vector<TableColumn>& table, const SweepPage& page) {
  const std::size_t rows = table.empty() ? 0 : rows_of(table.front());
  const auto title = escaped(page.title);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  // Nothing may be fetched from anywhere.
  html +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += fmt::format("<title>{} - Saltus</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n", title,
                      style, title);
  if (rows > rows_of_page)
    html += fmt::format("<p>The first {} of {} rows of the table are drawn.</p>\n", rows_of_page, rows);
  html +=
      "<div id=\"controls\"></div>\n<div id=\"pictures\"></div>\n"
      "<div id=\"run\"><span id=\"chosen\"></span><br><code id=\"command\"></code></div>\n</main>\n";
  html += fmt::format(
      "<script type=\"application/json\" id=\"sweep\">{}</script>\n<script>\n{}</script>\n</body>\n</html>\n",
      data_of(table, page), embedded::sweep_page_script);
  return html;
}

}  // namespace saltus::cli
