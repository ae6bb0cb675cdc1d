#include "saltus/result/difference.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "saltus/result/kept_columns.hpp"

namespace saltus::result {
namespace {

/// The tolerances of one column.
struct Allowed {
  double rtol, atol;
};

/// How often the tolerance the difference is; 0 for two numbers that are missing.
double excess(double a, double b, const Allowed& tolerances) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0.0;
  const double allowed = tolerances.atol + tolerances.rtol * std::max(std::abs(a), std::abs(b));
  const double ratio = std::abs(a - b) / allowed;
  return std::isnan(ratio) ? INFINITY : ratio;
}

/// As many digits as it takes to tell it from its neighbours.
std::string number_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return "[" + text + "]";
}

std::optional<Error> different_models(const Result& a, const Result& b) {
  const auto refuse = [](const std::string& what, const std::string& difference) {
    return Error{ErrorCode::invalid_model,
                 "these are results of different models: " + what + " " + difference,
                 "compare two runs of one model",
                 {},
                 {}};
  };
  if (a.model.name != b.model.name) {
    return refuse("they are named", "'" + a.model.name + "' and '" + b.model.name + "'");
  }
  const std::pair<const char*, std::vector<std::string> Result::*> lists[] = {
      {"their states are", &Result::states},
      {"their switching functions are", &Result::switching_functions},
      {"their outputs are", &Result::outputs}};
  for (const auto& [what, names] : lists) {
    if (a.*names != b.*names) return refuse(what, quoted_list(a.*names) + " and " + quoted_list(b.*names));
  }
  if (const auto equations = differing_equation(a, b); !equations.empty()) return refuse("they say", equations);
  return std::nullopt;
}

class Range {
 public:
  void include(double value) {
    if (!std::isfinite(value)) return;
    least_ = std::min(least_, value);
    greatest_ = std::max(greatest_, value);
  }
  [[nodiscard]] double width() const { return least_ < greatest_ ? greatest_ - least_ : 0.0; }

 private:
  double least_ = std::numeric_limits<double>::infinity();
  double greatest_ = -std::numeric_limits<double>::infinity();
};

/// Tolerances of every column: with none for small values a part of the column's range in both results, and no less
/// than they were computed with.
class AllowedDifferences {
 public:
  AllowedDifferences(const Result& a, const Result& b, const Tolerances& tolerances) : tolerances_(tolerances) {
    std::vector<Range> states(a.states.size()), outputs(a.outputs.size());
    Range t;
    for (const Result* one : {&a, &b}) {
      least_ = std::max(least_, computed_with(*one));
      for (const double when : one->trajectory.t) t.include(when);
      for (std::size_t k = 0; k < states.size(); ++k) include_state(*one, k, states[k]);
      for (const auto row : one->trajectory.outputs) {
        for (std::size_t k = 0; k < std::min(outputs.size(), row.size()); ++k) outputs[k].include(row[k]);
      }
    }
    time = of(t);
    for (const Range& range : states) {
      of_states.push_back(of(range));
      of_lines.push_back(of_states.back());
      of_lines.back().atol += line_error * range.width();
    }
    for (const Range& range : outputs) of_outputs.push_back(of(range));
  }
  Allowed time{};
  std::vector<Allowed> of_states{}, of_outputs{};
  std::vector<Allowed> of_lines{};  ///< of states between rows

 private:
  /// The lines of "auto" keep to a thousandth of the range.
  static constexpr double line_error = 2e-3;
  static double computed_with(const Result& result) {
    for (const auto& [name, value] : result.options) {
      if (name != "simulate.atol") continue;
      if (const auto* atol = std::get_if<double>(&value)) return *atol;
    }
    return 0.0;
  }
  static void include_state(const Result& result, std::size_t state, Range& range) {
    if (const auto column = column_of_state(result, state)) {
      for (const auto row : result.trajectory.x) range.include(row[*column]);
    }
    for (std::size_t i = 0; i < result.events.size(); ++i) {
      range.include(result.events.x(i)[state]);
      range.include(result.events.x_after(i)[state]);
    }
    if (state < result.final.x.size()) range.include(result.final.x[state]);
  }
  [[nodiscard]] Allowed of(const Range& range) const {
    return {tolerances_.rtol, tolerances_.atol.value_or(std::max(least_, tolerances_.rtol * range.width()))};
  }
  const Tolerances& tolerances_;
  double least_ = 0.0;
};

void compare_list(const std::vector<std::string>& names, const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<Allowed>& allowed, std::vector<NumberDifference>& found) {
  for (std::size_t i = 0; i < std::min({names.size(), a.size(), b.size()}); ++i) {
    if (excess(a[i], b[i], allowed[i]) > 1.0) found.push_back({names[i], a[i], b[i]});
  }
}

/// A state that the rows of both have, and where it is farthest apart of where it differs: rows have closer tolerances
/// than lines.
struct CommonColumn {
  std::string name;
  std::size_t of_a, of_b;
  Allowed allowed, of_line;
  double farthest = 0.0;
  std::optional<NumberDifference> found{};

  void compare(double t, double in_a, double in_b, const Allowed& tolerances) {
    if (excess(in_a, in_b, tolerances) <= 1.0) return;
    const double apart = std::isnan(in_a - in_b) ? INFINITY : std::abs(in_a - in_b);
    if (apart <= farthest) return;
    farthest = apart;
    found = {name + " at t = " + number_text(t), in_a, in_b};
  }
};

bool has_true_lines(const Result& result) {
  for (const auto& [name, value] : result.options) {
    const auto* word = std::get_if<std::string>(&value);
    if (name == "simulate.output" && word != nullptr && *word == "auto") return true;
  }
  return false;
}

/// Ascending times of the events of both.
std::vector<double> event_times(const Result& a, const Result& b) {
  std::vector<double> times;
  for (const Result* one : {&a, &b}) {
    for (std::size_t i = 0; i < one->events.size(); ++i) times.push_back(one->events.t(i));
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// The rows of one against the lines between those of the other.
void compare_lines(const Result& rows, const Result& lines, bool swapped, const std::vector<double>& events,
                   const Allowed& time, std::vector<CommonColumn>& columns, Difference& difference) {
  const auto& t = lines.trajectory.t;
  for (std::size_t i = 0; i < rows.trajectory.t.size(); ++i) {
    const double when = rows.trajectory.t[i];
    if (when > lines.statistics.thinned_from.value_or(when)) break;  // lines between few rows say nothing
    const auto behind = std::lower_bound(t.begin(), t.end(), when);
    if (behind == t.begin() || behind == t.end() || *behind == when) continue;
    const double near = time.atol + time.rtol * std::abs(when);
    const auto event = std::lower_bound(events.begin(), events.end(), when - near);
    if (event != events.end() && *event <= when + near) continue;
    ++difference.between_times;
    const auto j = static_cast<std::size_t>(behind - t.begin());
    const double part = (when - t[j - 1]) / (t[j] - t[j - 1]);
    for (auto& column : columns) {
      const auto of_row = swapped ? column.of_b : column.of_a, of_line = swapped ? column.of_a : column.of_b;
      const double on_row = rows.trajectory.x[i][of_row];
      const double before = lines.trajectory.x[j - 1][of_line];
      const double on_line = before + part * (lines.trajectory.x[j][of_line] - before);
      column.compare(when, swapped ? on_line : on_row, swapped ? on_row : on_line, column.of_line);
    }
  }
}

void compare_parameters(const Result& a, const Result& b, Difference& difference) {
  for (const auto& [name, value] : a.model.parameters) {
    for (const auto& [other, its_value] : b.model.parameters) {
      if (name == other && value != its_value) difference.parameters.push_back({name, value, its_value});
    }
  }
}

/// The states of two lists of rows at times that both have; rows of one time (at events) in their order.
void compare_rows(const Result& a, const Result& b, const AllowedDifferences& allowed, Difference& difference) {
  const auto& [first, second] = std::pair<const Trajectory&, const Trajectory&>(a.trajectory, b.trajectory);
  std::vector<CommonColumn> columns;
  for (std::size_t k = 0; k < a.states.size(); ++k) {
    const auto of_a = column_of_state(a, k), of_b = column_of_state(b, k);
    if (of_a && of_b) columns.push_back({a.states[k], *of_a, *of_b, allowed.of_states[k], allowed.of_lines[k]});
  }
  difference.common_states = columns.size();
  std::size_t i = 0, j = 0;
  while (i < first.t.size() && j < second.t.size()) {
    if (first.t[i] != second.t[j]) {
      ++(first.t[i] < second.t[j] ? i : j);
      continue;
    }
    ++difference.common_times;
    for (auto& column : columns) {
      column.compare(first.t[i], first.x[i][column.of_a], second.x[j][column.of_b], column.allowed);
    }
    ++i, ++j;
  }
  const auto events = event_times(a, b);
  if (has_true_lines(b)) compare_lines(a, b, false, events, allowed.time, columns, difference);
  if (has_true_lines(a)) compare_lines(b, a, true, events, allowed.time, columns, difference);
  for (auto& column : columns) {
    if (column.found) difference.rows.push_back(std::move(*column.found));
  }
}

std::string text_of(const Event& event) {
  std::string text(name(event.kind));
  if (event.name) text += " " + *event.name;
  for (const auto& surface : event.surfaces) {
    if (surface != event.name) text += " " + surface;
  }
  return text;
}

/// What differs between two events; empty if nothing does.
std::string event_difference(const Event& a, const Event& b, const std::vector<std::string>& states,
                             const AllowedDifferences& allowed) {
  if (text_of(a) != text_of(b)) return text_of(a) + " and " + text_of(b);
  const auto pair = [](double first, double second) { return number_text(first) + " and " + number_text(second); };
  if (excess(a.t, b.t, allowed.time) > 1.0) return text_of(a) + ": t = " + pair(a.t, b.t);
  for (const auto& [first, second] : {std::pair{&a.x, &b.x}, std::pair{&a.x_after, &b.x_after}}) {
    std::vector<NumberDifference> found;
    compare_list(states, *first, *second, allowed.of_states, found);
    if (!found.empty()) return text_of(a) + ": " + found.front().what + " = " + pair(found.front().a, found.front().b);
  }
  return "";
}

}  // namespace

std::string differing_equation(const Result& a, const Result& b) {
  const auto& [first, second] = std::pair<const std::vector<StatedEquation>&, const std::vector<StatedEquation>&>(
      a.model.equations, b.model.equations);
  const auto text = [](const StatedEquation& equation) {
    return equation.left + " = " + equation.right + (equation.where.empty() ? "" : " (" + equation.where + ")");
  };
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
    if (text(first[i]) != text(second[i])) return text(first[i]) + " and " + text(second[i]);
  }
  return "";
}

Expected<Difference> difference(const Result& a, const Result& b, const Tolerances& tolerances) {
  if (auto error = different_models(a, b)) return tl::unexpected(*error);
  Difference difference;
  compare_parameters(a, b, difference);
  if (a.status.termination != b.status.termination) {
    difference.ends = std::string(name(a.status.termination)) + " and " + std::string(name(b.status.termination));
  }
  const AllowedDifferences allowed(a, b, tolerances);
  compare_list({"t"}, {a.final.t}, {b.final.t}, {allowed.time}, difference.end_state);
  compare_list(a.states, a.final.x, b.final.x, allowed.of_states, difference.end_state);
  compare_list(a.outputs, a.final.outputs, b.final.outputs, allowed.of_outputs, difference.end_state);
  compare_rows(a, b, allowed, difference);
  difference.events_a = a.events.size();
  difference.events_b = b.events.size();
  for (std::size_t i = 0; i < std::min(a.events.size(), b.events.size()) && difference.first_event.empty(); ++i) {
    const auto what = event_difference(a.events[i], b.events[i], a.states, allowed);
    if (!what.empty()) difference.first_event = "event " + std::to_string(i + 1) + ": " + what;
  }
  return difference;
}

}  // namespace saltus::result
