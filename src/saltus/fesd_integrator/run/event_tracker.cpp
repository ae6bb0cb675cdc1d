#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/event_tracker_internal.hpp"
#include "saltus/ode/bernstein.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Of an element in which an event function is too fast for one interpolant: 2^10 parts resolve a thousand zeros.
constexpr int most_halvings_for_zeros = 10;

}  // namespace

EventTracker::EventTracker(RunContext& context, Position& position, ElementInterior& interior, OutputRows& rows,
                           Recorder& recorder, RunStatus& status)
    : context_(context),
      position_(position),
      interior_(interior),
      rows_(rows),
      recorder_(recorder),
      status_(status),
      events_(context.functions, context.facts.events, context.options.until - context.options.from),
      values_(events_.functions()) {}

void EventTracker::start() {
  if (events_.empty()) return;
  static_cast<void>(events_.update(position_.t(), position_.x().data(), position_.selections().data(),
                                   context_.held.data(), std::nullopt));
}

void EventTracker::sample(const Element& element, const std::vector<double>& selections, const Stretch& part) {
  const std::size_t n = events_.functions();
  samples_.resize((ode::event_nodes + ode::event_degree) * n);
  double* values = samples_.data();
  const auto sample = [&](double node) {
    const double theta = part.from + node * (part.to - part.from);
    interior_.go_to(element, selections, theta);
    context_.functions.event_values(element.t + theta * element.h, interior_.x().data(), interior_.selections().data(),
                                    context_.held.data(), values);
    values += n;
  };
  for (const double node : ode::interpolation_nodes()) sample(node);
  for (const double node : ode::check_nodes()) sample(node);
}

EventTracker::Look EventTracker::look_for_zero(std::size_t function, const Element& element,
                                               const Stretch& part) const {
  const std::size_t n = events_.functions();
  const int sign = events_.sign(function);
  if (sign == 0) return {};
  std::array<double, ode::event_nodes> values{};
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = samples_[i * n + function];
    largest = std::max(largest, std::abs(values[i]));
  }
  if (!std::isfinite(largest)) return {};
  const double noise = 16.0 * rounding_unit * std::max(largest, element.size);
  const auto coefficients = ode::to_bernstein(values);
  double error = 0.0;
  for (std::size_t i = 0; i < ode::check_nodes().size(); ++i) {
    const double value = samples_[(values.size() + i) * n + function];
    error = std::max(error, std::abs(value - ode::evaluate(coefficients, ode::check_nodes()[i])));
  }
  // What an interpolant of this error leaves of a zero, Newton's method mends; twenty times the error cannot be
  // missing between the nodes where it was looked at.
  constexpr double close = 1e-3, seen = 20.0;
  const bool away = ode::certainly_no_sign_change(coefficients, sign, 0, -std::max(noise, seen * error));
  if (!(error <= std::max(close * largest, noise)) && !away && part.halvings > 0)
    return {Look::Answer::unresolved, 0.0};
  const bool crossed = events_.crosses_at(function, element.t + part.from * element.h);
  const int zero_order = crossed || (part.behind_zeros && std::abs(values.front()) <= noise) ? 1 : 0;
  const auto change = ode::first_sign_change(coefficients, sign, zero_order, noise);
  if (!change) return {};
  return {Look::Answer::zero, part.from + change->upper * (part.to - part.from)};
}

/// The earliest zero of an event function in a part of an element; functions that are at zero where the first part
/// begins have no sign to change. Parts in which an interpolant may miss a zero are halved.
std::optional<EventTracker::Zero> EventTracker::first_zero(const Element& element,
                                                           const std::vector<double>& selections, const Stretch& part) {
  sample(element, selections, part);
  std::optional<Zero> first;
  bool resolved = true;
  for (std::size_t k = 0; k < events_.functions() && resolved; ++k) {
    const Look look = look_for_zero(k, element, part);
    resolved = look.answer != Look::Answer::unresolved;
    if (look.answer == Look::Answer::zero && (!first || look.theta < first->theta)) first = Zero{k, look.theta};
  }
  if (resolved) return first;
  const double middle = 0.5 * (part.from + part.to);
  first = first_zero(element, selections, {part.from, middle, part.halvings - 1, part.behind_zeros});
  return first ? first : first_zero(element, selections, {middle, part.to, part.halvings - 1, false});
}

double EventTracker::value_at(double t, const std::vector<double>& x, std::size_t function) {
  context_.functions.event_values(t, x.data(), interior_.selections().data(), context_.held.data(), values_.data());
  return values_[function];
}

double EventTracker::value_inside(const Element& element, const std::vector<double>& selections, double theta,
                                  std::size_t function) {
  interior_.go_to(element, selections, theta);
  return value_at(element.t + theta * element.h, interior_.x(), function);
}

/// The zero is where an element that begins with this one, and is shorter, ends at zero.
EventTracker::Refined EventTracker::refine(const Element& element, const std::vector<double>& selections,
                                           const Zero& zero) {
  interior_.go_to(element, selections, zero.theta);
  Refined found{zero.theta, interior_.x(), interior_.selections()};
  const Point left{element.t, element.x, selections, element.size};
  double theta = zero.theta, theta_before = 0.0, value_before = 0.0, best = std::numeric_limits<double>::infinity();
  constexpr int most_iterations = 20;
  for (int i = 0; i < most_iterations; ++i) {
    shorter_.warp = {element.warp.left, 1};
    if (context_.solver.solve(left, theta * element.h, {&position_.set(), 1}, context_.held.data(),
                              position_.first_guess(), shorter_) != ElementSolver::Outcome::solved) {
      break;
    }
    const double t = element.t + theta * element.h;
    if (!interior_.project(t, shorter_.end, selections)) break;
    const double value = value_at(t, shorter_.end, zero.function);
    if (!(std::abs(value) < best)) break;  // at the rounding level, or astray
    best = std::abs(value);
    found = {theta, shorter_.end, interior_.selections()};
    if (value == 0.0) break;
    double slope = (value - value_before) / (theta - theta_before);
    if (i == 0) {
      constexpr double small = 1e-4;
      const double before = value_inside(element, selections, theta - small, zero.function);
      slope = (value_inside(element, selections, theta, zero.function) - before) / small;
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
void EventTracker::settle_signs(const Element& element, const std::vector<double>& selections) {
  constexpr double nearest = 1e-6, farthest = 1e-2;
  for (double theta = nearest; theta < farthest && events_.unsettled(); theta *= 4.0) {
    interior_.go_to(element, selections, theta);
    events_.settle(element.t + theta * element.h, interior_.x().data(), interior_.selections().data(),
                   context_.held.data());
  }
}

bool EventTracker::record(const Element& element, const std::vector<double>& left, double end) {
  if (events_.empty()) {
    rows_.emit(element, left, end);
    return true;
  }
  settle_signs(element, left);
  double from = 0.0;
  constexpr int most_per_element = 1000;
  for (int count = 0; count < most_per_element && from < 1.0; ++count) {
    const auto zero = first_zero(element, left, {from, 1.0, most_halvings_for_zeros, true});
    if (!zero) break;
    const Refined at = refine(element, left, *zero);
    const double theta = std::max(from, at.theta);
    const double t = theta >= 1.0 ? end : element.t + theta * element.h;
    rows_.emit(element, left, t);
    const auto fired = events_.update(t, at.x.data(), at.selections.data(), context_.held.data(), zero->function);
    if (fire(fired, t, at.x, at.selections)) return false;
    from = std::min(1.0, std::max(theta, zero->theta));
  }
  rows_.emit(element, left, end);
  return true;
}

bool EventTracker::update_here(std::optional<std::size_t> crossed) {
  if (events_.empty()) return false;
  const auto fired =
      events_.update(position_.t(), position_.x().data(), position_.selections().data(), context_.held.data(), crossed);
  return fire(fired, position_.t(), position_.x(), position_.selections());
}

/// What gets to zero at a switch has its zero there, whether it goes on or stays (v where a block sticks).
void EventTracker::fire_at_switch() {
  if (events_.empty()) return;
  if (update_here()) return;
  const double noise = 16.0 * rounding_unit * position_.size();
  for (std::size_t k = 0; k < events_.functions(); ++k) {
    const bool reached = events_.reaches_zero(k, noise) && !events_.crosses_at(k, position_.t());
    if (reached && events_.sign(k) != 0 && update_here(k)) return;
  }
}

bool EventTracker::fire(const std::vector<std::size_t>& fired, double t, const std::vector<double>& x,
                        const std::vector<double>& selections) {
  for (const std::size_t event : fired) {
    const bool condition = context_.facts.events[event].rule.condition;
    recorder_.user(t, x, {&position_.set(), &selections, context_.held.data()}, event,
                   condition ? "edge of a condition of [[events]]" : "zero of an expression of [[events]]");
    if (!context_.facts.events[event].stop) continue;
    position_.stop_inside(t, x, selections);
    status_.stop(t, result::Termination::stopped_by_event,
                 fmt::format("event \"{}\" at t = {:.10g}", context_.facts.events[event].name, t));
    return true;
  }
  return false;
}

}  // namespace saltus::fesd_integrator
