// Events the user asked for: zeros of expressions and edges of conditions, seen along elements that are accepted.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/discretization/point_functions.hpp"
#include "saltus/fesd_integrator/facts.hpp"
#include "saltus/model/event_rules.hpp"

namespace saltus::fesd_integrator {

/// Signs of the event functions and truths of the conditions as they were last, and what a change of them means.
class UserEvents {
 public:
  /// The functions must outlive it.
  UserEvents(const discretization::PointFunctions& functions, const std::vector<EventFact>& facts);

  [[nodiscard]] bool empty() const { return signs_.empty(); }
  [[nodiscard]] std::size_t functions() const { return signs_.size(); }
  /// The sign of a function as it was last; 0 at a zero it started from.
  [[nodiscard]] int sign(std::size_t function) const { return signs_[function]; }
  /// Takes over the signs at a point, where those of functions within their rounding stay, and that of `crossed` is the
  /// other one.
  /// @return the events that this fires, in the order of the model
  [[nodiscard]] std::vector<std::size_t> update(double t, const double* x, const double* selections, const double* held,
                                                std::optional<std::size_t> crossed);

 private:
  const discretization::PointFunctions& functions_;
  model::EventStates states_;
  std::vector<double> values_;
  std::vector<int> signs_;
};

}  // namespace saltus::fesd_integrator
