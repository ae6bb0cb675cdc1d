// What the option table says to people: --help and docs/options.md.
#include <fmt/format.h>

#include "saltus/pipeline/options/option_fields.hpp"

namespace saltus::pipeline {
namespace {

/// The default of a field as text, read from default options, so that it is stated nowhere twice.
std::string default_text(const OptionField& field) {
  result::OptionRecord record;
  field.record(SimulateOptions{}, field.key, record);
  return record.empty() ? "" : to_text(record.front().second);
}

constexpr std::string_view page_head =
    R"(# Options of a simulation

Generated from the option table of the source (`saltus options-page > docs/options.md`; a test compares).

Write them in the model file under `[simulate]` (`[simulate.event]` for those that begin with `event.`, and so on), or on
the command line as `--set simulate.KEY=VALUE`, tables as they stand in a file, in quotes of the shell:
`--set 'simulate.output={ points = 101 }'`. `*` stands for the name of a switching function. `output` is one of
`"auto"`, `"steps"` (no rows between), `{ every = … }`, `{ points = … }`, `{ times = […] }`; `until` is a row, unless rows are at given times, and
events and end state do not depend on it. Of more than 250 000 rows `"auto"` leaves out those between events that are less than the span / 250 000
after another row (`thinned_from` in the statistics); `"steps"` never does.

| key | value | default | meaning |
|---|---|---|---|
)";

constexpr std::string_view page_tail = R"md(
Values of the controls during a simulation stand in `inputs = { u = "sin(t)" }`: expressions of the time and the
parameters, or piecewise constant as `{ file = "u.csv" }` (columns t and u), `{ result = "r.json" }` (the control of that
name in a stored result; files are relative to the model's) or `{ times = [0, 1], values = [2, 3] }`; without one a control
keeps its `initial`. On the command line:
`--set simulate.inputs.u="sin(t)"`, `--set simulate.inputs.u.file=u.csv`.
)md";

}  // namespace

std::string to_text(const result::OptionValue& value) {
  struct Writer {
    std::string operator()(bool truth) const { return truth ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return fmt::format("{}", integer); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const std::string& word) const { return fmt::format("\"{}\"", word); }
    std::string operator()(const std::vector<double>& list) const { return fmt::format("[{}]", fmt::join(list, ", ")); }
    std::string operator()(const std::vector<std::string>& list) const {
      return list.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(list, "\", \""));
    }
  };
  return std::visit(Writer{}, value);
}

std::string options_help() {
  std::string text;
  for (const auto& field : simulate_fields()) {
    const auto standard = default_text(field);
    const auto value =
        fmt::format("{}{}", expects(field.kind), standard.empty() ? "" : fmt::format("; default {}", standard));
    const bool fits = field.key.size() + value.size() < 110;
    text += fmt::format("  {:<17}{}{}\n        {}\n", field.key, fits ? " " : "\n        ", value, field.doc);
  }
  return text;
}

std::string options_page() {
  std::string text(page_head);
  for (const auto& field : simulate_fields()) {
    const auto standard = default_text(field);
    text += fmt::format("| `{}` | {} | {} | {} |\n", field.key, expects(field.kind),
                        standard.empty() ? "" : fmt::format("`{}`", standard), field.doc);
  }
  return text.append(page_tail);
}

}  // namespace saltus::pipeline
