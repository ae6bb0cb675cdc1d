// Events the user asked for: zeros of expressions and edges of conditions, seen along elements that are accepted.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "saltus/base/contains.hpp"
#include "saltus/discretization/point_functions.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/model/statement/event_rules.hpp"

namespace saltus::fesd_integrator {

/// Holds the signs of the event functions and truths of the conditions as they were last, and what a change of them
/// means.
class UserEvents {
 public:
  /// The functions must outlive it. `span`: of the run, in units of time.
  UserEvents(const discretization::PointFunctions& functions, const std::vector<EventFact>& facts, double span);

  [[nodiscard]] bool empty() const { return signs_.empty(); }
  [[nodiscard]] std::size_t functions() const { return signs_.size(); }
  /// Returns the sign of a function as it was last; 0 at a zero it started from.
  [[nodiscard]] int sign(std::size_t function) const { return signs_[function]; }
  /// Returns whether a zero of the function was crossed here: what is left of its value is the rounding of the time.
  [[nodiscard]] bool crosses_at(std::size_t function, double t) const {
    return t - crossed_at_[function] <= resolution(t);
  }
  /// Gives functions that have no sign yet, but have left zero at this point, their first one: that is no change.
  void settle(double t, const double* x, const double* selections, const double* held);
  /// Returns whether some function has no sign yet.
  [[nodiscard]] bool unsettled() const { return contains(signs_, 0); }
  /// Returns whether the value is within `noise` of zero where update() was called last, and was not at the time before
  /// that.
  [[nodiscard]] bool reaches_zero(std::size_t function, double noise) const {
    return std::abs(values_[function]) <= noise && std::abs(values_before_[function]) > noise;
  }
  /// Takes over the signs at a point. Those of functions within their rounding, or crossed here, stay. That of
  /// `crossed` is the other one.
  /// @return the events that this fires, in the order of the model
  [[nodiscard]] std::vector<std::size_t> update(double t, const double* x, const double* selections, const double* held,
                                                std::optional<std::size_t> crossed);

 private:
  [[nodiscard]] double resolution(double t) const;
  [[nodiscard]] std::vector<std::size_t> changes(double t, const double* x, const double* selections,
                                                 const double* held);

  const discretization::PointFunctions& functions_;
  model::EventStates states_;
  double t_ = -std::numeric_limits<double>::infinity();
  std::vector<double> values_, values_before_;  ///< at t_, and at the last time before it
  double span_;
  std::vector<int> signs_;
  std::vector<double> crossed_at_;  ///< time of the last zero of each function
};

}  // namespace saltus::fesd_integrator
