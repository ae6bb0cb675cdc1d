#include "saltus/result/difference.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace saltus::result {
namespace {

/// How often the tolerance the difference is; 0 for two numbers that are missing.
double excess(double a, double b, const Tolerances& tolerances) {
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
  const auto refuse = [](const std::string& what, const std::string& first, const std::string& second) {
    return Error{ErrorCode::invalid_model,
                 "these are results of different models: " + what + " " + first + " and " + second,
                 "compare two runs of one model",
                 {},
                 {}};
  };
  if (a.model.name != b.model.name) return refuse("they are named", "'" + a.model.name + "'", "'" + b.model.name + "'");
  const std::pair<const char*, std::vector<std::string> Result::*> lists[] = {
      {"their states are", &Result::states},
      {"their switching functions are", &Result::switching_functions},
      {"their outputs are", &Result::outputs}};
  for (const auto& [what, names] : lists) {
    if (a.*names != b.*names) return refuse(what, quoted_list(a.*names), quoted_list(b.*names));
  }
  return std::nullopt;
}

void compare_list(const std::vector<std::string>& names, const std::vector<double>& a, const std::vector<double>& b,
                  const Tolerances& tolerances, std::vector<NumberDifference>& found) {
  for (std::size_t i = 0; i < std::min({names.size(), a.size(), b.size()}); ++i) {
    if (excess(a[i], b[i], tolerances) > 1.0) found.push_back({names[i], a[i], b[i]});
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
void compare_rows(const Result& a, const Result& b, const Tolerances& tolerances, Difference& difference) {
  const auto& [first, second] = std::pair<const Trajectory&, const Trajectory&>(a.trajectory, b.trajectory);
  std::vector<double> worst(a.states.size(), 1.0);
  std::vector<std::optional<NumberDifference>> found(a.states.size());
  std::size_t i = 0, j = 0;
  while (i < first.t.size() && j < second.t.size()) {
    if (first.t[i] != second.t[j]) {
      ++(first.t[i] < second.t[j] ? i : j);
      continue;
    }
    ++difference.common_times;
    for (std::size_t k = 0; k < a.states.size(); ++k) {
      const double ratio = excess(first.x[i][k], second.x[j][k], tolerances);
      if (ratio <= worst[k]) continue;
      worst[k] = ratio;
      found[k] = {a.states[k] + " at t = " + number_text(first.t[i]), first.x[i][k], second.x[j][k]};
    }
    ++i, ++j;
  }
  for (auto& state : found) {
    if (state) difference.rows.push_back(std::move(*state));
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
                             const Tolerances& tolerances) {
  if (text_of(a) != text_of(b)) return text_of(a) + " and " + text_of(b);
  const auto pair = [](double first, double second) { return number_text(first) + " and " + number_text(second); };
  if (excess(a.t, b.t, tolerances) > 1.0) return text_of(a) + ": t = " + pair(a.t, b.t);
  for (const auto& [first, second] : {std::pair{&a.x, &b.x}, std::pair{&a.x_after, &b.x_after}}) {
    std::vector<NumberDifference> found;
    compare_list(states, *first, *second, tolerances, found);
    if (!found.empty()) return text_of(a) + ": " + found.front().what + " = " + pair(found.front().a, found.front().b);
  }
  return "";
}

}  // namespace

Expected<Difference> difference(const Result& a, const Result& b, const Tolerances& tolerances) {
  if (auto error = different_models(a, b)) return tl::unexpected(*error);
  Difference difference;
  compare_parameters(a, b, difference);
  if (a.status.termination != b.status.termination) {
    difference.ends = std::string(name(a.status.termination)) + " and " + std::string(name(b.status.termination));
  }
  compare_list({"t"}, {a.final.t}, {b.final.t}, tolerances, difference.end_state);
  compare_list(a.states, a.final.x, b.final.x, tolerances, difference.end_state);
  compare_list(a.outputs, a.final.outputs, b.final.outputs, tolerances, difference.end_state);
  compare_rows(a, b, tolerances, difference);
  difference.events_a = a.events.size();
  difference.events_b = b.events.size();
  for (std::size_t i = 0; i < std::min(a.events.size(), b.events.size()) && difference.first_event.empty(); ++i) {
    const auto what = event_difference(a.events[i], b.events[i], a.states, tolerances);
    if (!what.empty()) difference.first_event = "event " + std::to_string(i + 1) + ": " + what;
  }
  return difference;
}

}  // namespace saltus::result
