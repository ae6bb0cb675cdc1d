// User events along accepted elements.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Of an element in which an event function is too fast for one interpolant: 2^10 parts resolve a thousand zeros.
constexpr int most_halvings_for_zeros = 10;

}  // namespace

/// Values of the event functions at a part of an element, into event_values_: at the nodes of an interpolant, then at
/// those where it is checked.
void Run::sample_events(const Element& element, const std::vector<double>& selections, const Stretch& part) {
  const std::size_t n = user_events_.functions();
  event_values_.resize((ode::event_nodes + ode::event_degree) * n);
  double* values = event_values_.data();
  const auto sample = [&](double node) {
    const double theta = part.from + node * (part.to - part.from);
    event_state(element, selections, theta);
    functions_.event_values(element.t + theta * element.h, between_x_.data(), between_selections_.data(), held_.data(),
                            values);
    values += n;
  };
  for (const double node : ode::interpolation_nodes()) sample(node);
  for (const double node : ode::check_nodes()) sample(node);
}

/// The earliest zero of an event function in a part of an element; functions that are at zero where the first part
/// begins have no sign to change. Parts in which an interpolant may miss a zero are halved.
std::optional<Run::EventZero> Run::first_event_zero(const Element& element, const std::vector<double>& selections,
                                                    const Stretch& part) {
  const std::size_t n = user_events_.functions();
  sample_events(element, selections, part);
  std::optional<EventZero> first;
  bool resolved = true;
  for (std::size_t k = 0; k < n; ++k) {
    const int sign = user_events_.sign(k);
    if (sign == 0) continue;
    std::array<double, ode::event_nodes> values{};
    double largest = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = event_values_[i * n + k];
      largest = std::max(largest, std::abs(values[i]));
    }
    if (!std::isfinite(largest)) continue;
    const double noise = 16.0 * rounding_unit * std::max(largest, element.size);
    const auto coefficients = ode::to_bernstein(values);
    double error = 0.0;
    for (std::size_t i = 0; i < ode::check_nodes().size(); ++i) {
      const double value = event_values_[(values.size() + i) * n + k];
      error = std::max(error, std::abs(value - ode::evaluate(coefficients, ode::check_nodes()[i])));
    }
    // What an interpolant of this error leaves of a zero, Newton's method mends; twenty times the error cannot be
    // missing between the nodes where it was looked at.
    constexpr double close = 1e-3, seen = 20.0;
    const bool away = ode::certainly_no_sign_change(coefficients, sign, 0, -std::max(noise, seen * error));
    if (!(error <= std::max(close * largest, noise)) && !away && part.halvings > 0) {
      resolved = false;
      break;
    }
    const bool crossed = user_events_.crosses_at(k, element.t + part.from * element.h);
    const int zero_order = crossed || (part.behind_zeros && std::abs(values.front()) <= noise) ? 1 : 0;
    const auto change = ode::first_sign_change(coefficients, sign, zero_order, noise);
    if (!change) continue;
    const double theta = part.from + change->upper * (part.to - part.from);
    if (!first || theta < first->theta) first = EventZero{k, theta};
  }
  if (resolved) return first;
  const double middle = 0.5 * (part.from + part.to);
  first = first_event_zero(element, selections, {part.from, middle, part.halvings - 1, part.behind_zeros});
  return first ? first : first_event_zero(element, selections, {middle, part.to, part.halvings - 1, false});
}

/// State and selections inside an element, into between_x_ and between_selections_.
void Run::event_state(const Element& element, const std::vector<double>& selections, double theta) {
  solver_.interpolate(element, theta, between_x_.data());
  between_selections_ = selections;
  if (!project_selections(element.t + theta * element.h, between_x_)) between_selections_ = selections;
}

/// From between_selections_ to those that hold the surfaces at a point; those nearest to 1/2 where they are not
/// determined.
bool Run::project_selections(double t, const std::vector<double>& x) {
  if (set_.sliding().empty()) return true;
  if (!projected_.solve(t, x.data(), set_, held_.data(), between_selections_.data())) return false;
  if (!set_.balances().empty()) {
    margins_.evaluate(set_, field_view(projected_.values()), between_selections_.data());
  }
  return true;
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
    if (!project_selections(t, shorter_.end)) break;
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

/// What is at zero where an element begins gets the sign that it has behind, which is no change.
void Run::settle_event_signs(const Element& element, const std::vector<double>& selections) {
  constexpr double nearest = 1e-6, farthest = 1e-2;
  for (double theta = nearest; theta < farthest && user_events_.unsettled(); theta *= 4.0) {
    event_state(element, selections, theta);
    user_events_.settle(element.t + theta * element.h, between_x_.data(), between_selections_.data(), held_.data());
  }
}

bool Run::record_user_events(const Element& element, const std::vector<double>& left, double end) {
  settle_event_signs(element, left);
  double from = 0.0;
  constexpr int most_per_element = 1000;
  for (int count = 0; count < most_per_element && from < 1.0; ++count) {
    const auto zero = first_event_zero(element, left, {from, 1.0, most_halvings_for_zeros, true});
    if (!zero) break;
    event_state(element, left, zero->theta);
    std::vector<double> x = between_x_, at = between_selections_;
    const double theta = std::max(from, refined_event(element, left, *zero, x, at));
    const double t = theta >= 1.0 ? end : element.t + theta * element.h;
    emit_times(&element, left, t);
    const auto fired = user_events_.update(t, x.data(), at.data(), held_.data(), zero->function);
    if (fire(fired, t, x, at)) return false;
    from = std::min(1.0, std::max(theta, zero->theta));
  }
  emit_times(&element, left, end);
  return true;
}

/// What gets to zero at a switch has its zero there, whether it goes on or stays (v where a block sticks).
void Run::fire_events_here() {
  if (user_events_.empty()) return;
  const auto take = [&](std::optional<std::size_t> crossed) {
    return fire(user_events_.update(t_, x_.data(), selections_.data(), held_.data(), crossed), t_, x_, selections_);
  };
  if (take(std::nullopt)) return;
  const double noise = 16.0 * rounding_unit * size_;
  for (std::size_t k = 0; k < user_events_.functions(); ++k) {
    const bool reached = user_events_.reaches_zero(k, noise) && !user_events_.crosses_at(k, t_);
    if (reached && user_events_.sign(k) != 0 && take(k)) return;
  }
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
