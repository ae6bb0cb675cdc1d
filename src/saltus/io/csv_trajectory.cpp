#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/io/json_result.hpp"

namespace saltus::io {
namespace {

/// RFC 4180: fields with a comma, a quote or a line break stand in quotes, quotes are doubled.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

template <class Row>
void append(std::string& text, const Row& row) {
  for (const auto value : row) fmt::format_to(std::back_inserter(text), ",{}", value);
}

/// One line for every row, each with `end` behind it.
void append_rows(std::string& text, const result::Trajectory& trajectory, const std::string& end) {
  for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}", trajectory.t[i]);
    append(text, trajectory.x[i]);
    append(text, trajectory.u[i]);
    append(text, trajectory.alpha[i]);
    append(text, trajectory.mode[i]);
    if (!trajectory.regions.empty()) {
      for (const auto& active : trajectory.regions[i]) text += "," + field(fmt::format("{}", fmt::join(active, "+")));
      append(text, trajectory.theta[i]);
    }
    text += end + "\n";
  }
}

}  // namespace

std::string to_csv(const result::Result& result) {
  std::string text = "t";
  for (const auto& state : result.states) text += "," + field(state);
  for (const auto& control : result.controls) text += "," + field(control);
  for (const auto& name : result.switching_functions) text += "," + field("alpha(" + name + ")");
  for (const auto& name : result.switching_functions) text += "," + field("mode(" + name + ")");
  for (const auto& group : result.region_groups) {
    text += "," + field(group.name.empty() ? "regions" : "regions(" + group.name + ")");
  }
  for (const auto& label : result::region_labels(result.region_groups)) text += "," + field("theta(" + label + ")");
  const bool with_branches = !result.branches.empty();
  text += with_branches ? ",branch\n" : "\n";
  for (const auto& [part, label, parent] : result::tree(result)) {
    append_rows(text, part->trajectory, with_branches ? "," + label : "");
  }
  return text;
}

}  // namespace saltus::io
