// User events along accepted elements.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run_internal.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::fesd_integrator {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

}  // namespace

/// The earliest zero of an event function in the part of an element behind `from`; functions that are at zero there
/// have no sign to change.
std::optional<Run::EventZero> Run::first_event_zero(const Element& element, const std::vector<double>& selections,
                                                    double from) {
  const auto& nodes = ode::interpolation_nodes();
  const std::size_t n = user_events_.functions();
  event_values_.resize(nodes.size() * n);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double theta = from + nodes[i] * (1.0 - from);
    event_state(element, selections, theta);
    functions_.event_values(element.t + theta * element.h, between_x_.data(), between_selections_.data(), held_.data(),
                            event_values_.data() + i * n);
  }
  std::optional<EventZero> first;
  for (std::size_t k = 0; k < n; ++k) {
    const int sign = user_events_.sign(k);
    if (sign == 0) continue;
    std::array<double, ode::event_nodes> values{};
    double largest = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      values[i] = event_values_[i * n + k];
      largest = std::max(largest, std::abs(values[i]));
    }
    if (!std::isfinite(largest)) continue;
    const double noise = 16.0 * rounding * std::max(largest, element.size);
    const int zero_order = std::abs(values.front()) <= noise ? 1 : 0;
    const auto change = ode::first_sign_change(ode::to_bernstein(values), sign, zero_order, noise);
    if (!change) continue;
    const double theta = from + change->upper * (1.0 - from);
    if (!first || theta < first->theta) first = EventZero{k, theta};
  }
  return first;
}

/// State and selections inside an element, into between_x_ and between_selections_.
void Run::event_state(const Element& element, const std::vector<double>& selections, double theta) {
  solver_.interpolate(element, theta, between_x_.data());
  between_selections_ = selections;
  if (set_.sliding().empty()) return;
  if (!projected_.solve(element.t + theta * element.h, between_x_.data(), set_, held_.data(),
                        between_selections_.data())) {
    between_selections_ = selections;
  }
}

/// The zero itself: where an element that begins with this one, and is shorter, ends at zero.
double Run::refined_event(const Element& element, const std::vector<double>& selections, const EventZero& zero,
                          std::vector<double>& x, std::vector<double>& at) {
  double theta = zero.theta, theta_before = 0.0, value_before = 0.0, best = std::numeric_limits<double>::infinity();
  double found = theta;
  std::vector<double> values(user_events_.functions());
  constexpr int most_iterations = 20;
  for (int i = 0; i < most_iterations; ++i) {
    const Point left{element.t, element.x, selections, element.size};
    shorter_.warp = {element.warp.left, 1};
    if (solver_.solve(left, theta * element.h, {&set_, 1}, held_.data(), ElementSolver::Guess::left_end, shorter_) !=
        ElementSolver::Outcome::solved) {
      break;
    }
    between_selections_ = selections;
    const double t = element.t + theta * element.h;
    if (!set_.sliding().empty() &&
        !projected_.solve(t, shorter_.end.data(), set_, held_.data(), between_selections_.data())) {
      break;
    }
    functions_.event_values(t, shorter_.end.data(), between_selections_.data(), held_.data(), values.data());
    const double value = values[zero.function];
    if (!(std::abs(value) < best)) break;  // at the rounding level, or astray
    best = std::abs(value);
    found = theta;
    x = shorter_.end;
    at = between_selections_;
    if (value == 0.0) break;
    double slope = (value - value_before) / (theta - theta_before);
    if (i == 0) {
      constexpr double small = 1e-4;
      event_state(element, selections, theta - small);
      std::vector<double> before(values.size());
      functions_.event_values(t - small * element.h, between_x_.data(), between_selections_.data(), held_.data(),
                              before.data());
      event_state(element, selections, theta);
      functions_.event_values(t, between_x_.data(), between_selections_.data(), held_.data(), values.data());
      slope = (values[zero.function] - before[zero.function]) / small;
    }
    theta_before = theta;
    value_before = value;
    const double next = theta - value / slope;
    if (!(next > 0.0 && next <= 1.0) || next == theta) break;
    theta = next;
  }
  return found;
}

bool Run::record_user_events(const Element& element, const std::vector<double>& left, double end) {
  double from = 0.0;
  constexpr int most_per_element = 1000;
  for (int count = 0; count < most_per_element; ++count) {
    const auto zero = first_event_zero(element, left, from);
    if (!zero) break;
    event_state(element, left, zero->theta);
    std::vector<double> x = between_x_, at = between_selections_;
    const double theta = std::max(from, refined_event(element, left, *zero, x, at));
    const double t = theta >= 1.0 ? end : element.t + theta * element.h;
    emit_times(&element, left, t);
    const auto fired = user_events_.update(t, x.data(), at.data(), held_.data(), zero->function);
    if (fire(fired, t, x, at)) return false;
    from = std::min(1.0, std::max(theta, zero->theta));
    if (from >= 1.0) break;
  }
  emit_times(&element, left, end);
  return true;
}

bool Run::fire(const std::vector<std::size_t>& fired, double t, const std::vector<double>& x,
               const std::vector<double>& selections) {
  for (const std::size_t event : fired) {
    const bool condition = facts_.events[event].rule.condition;
    recorder_.user(t, x, {&set_, &selections, held_.data()}, event,
                   condition ? "edge of a condition of [[events]]" : "zero of an expression of [[events]]");
    if (!facts_.events[event].stop) continue;
    t_ = t;
    x_ = x;
    selections_ = selections;
    stop(result::Termination::stopped_by_event,
         fmt::format("event \"{}\" at t = {:.10g}", facts_.events[event].name, t));
    return true;
  }
  return false;
}

}  // namespace saltus::fesd_integrator
