// What the table of the options of an optimisation says to people: --help and docs/options.md.
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "saltus/pipeline/options/optimize_fields.hpp"

namespace saltus::pipeline {
namespace {

/// The default of an option as text, read from default options, so that it is stated nowhere twice.
std::string default_of_optimize(const OptimizeField& field) {
  result::OptionRecord record;
  field.record(OptimizeOptions{}, field.key, record);
  return record.empty() ? "" : to_text(record.front().second);
}

constexpr std::string_view optimize_page_head = R"(
# Options of an optimisation

Write them in the model file under `[optimize]` (`[optimize.mpcc]` for those that begin with `mpcc.`), or on the command line as
`--set optimize.KEY=VALUE`. First the keys that state the problem ([model files](model-file.md#optimize)), then those of the method.

| key | value | default | meaning |
|---|---|---|---|
)";

constexpr std::size_t widest_line = 118;

/// Lines of words, no longer than the terminal.
std::string wrapped(std::string_view text, std::string_view indent) {
  std::string lines, line;
  while (!text.empty()) {
    const auto end = std::min(text.find(' '), text.size());
    const auto word = text.substr(0, end);
    if (!line.empty() && indent.size() + line.size() + 1 + word.size() > widest_line) {
      lines += fmt::format("{}{}\n", indent, line);
      line.clear();
    }
    line += fmt::format("{}{}", line.empty() ? "" : " ", word);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines + fmt::format("{}{}\n", indent, line);
}

}  // namespace

std::string optimize_options_help() {
  std::string text;
  for (const auto& key : problem_keys()) {
    text += fmt::format("  {:<22} {}\n        {}\n", key.key, key.expects, key.doc);
  }
  for (const auto& field : optimize_fields()) {
    const auto standard = default_of_optimize(field);
    const auto taken =
        fmt::format("{}{}", expects(field.kind), standard.empty() ? "" : fmt::format("; default {}", standard));
    auto block = wrapped(taken, "                         ");
    block.replace(2, field.key.size(), field.key);
    text += block + wrapped(field.doc, "        ");
  }
  return text;
}

std::string optimize_options_page() {
  std::string text(optimize_page_head);
  for (const auto& key : problem_keys()) {
    text += fmt::format("| `{}` | {} | | {} |\n", key.key, key.expects, key.doc);
  }
  for (const auto& field : optimize_fields()) {
    const auto standard = default_of_optimize(field);
    text += fmt::format("| `{}` | {} | {} | {} |\n", field.key, expects(field.kind),
                        standard.empty() ? "" : fmt::format("`{}`", standard), field.doc);
  }
  return text;
}

}  // namespace saltus::pipeline
