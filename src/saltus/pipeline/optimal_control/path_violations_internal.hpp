// How far a simulation leaves bounds and path constraints between the points at which an optimisation asks for them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/ocp_terms.hpp"
#include "saltus/result/optimization.hpp"

namespace saltus::pipeline {

/// Returns the larger one; what is not a number stays.
[[nodiscard]] double worse(double a, double b);

/// Returns by how much a value is outside of bounds.
[[nodiscard]] double violation(double value, double lower, double upper);

/// Returns what errors are divided by: a range, at least 1e-3 of finite bounds and 1e-6.
[[nodiscard]] double scale_of(double range, double lower, double upper);

/// Holds the bounds of a state, the infinite ones, too.
struct StateBounds {
  std::string name;
  double lower = 0.0, upper = 0.0;
};

/// Collects the largest violation of every hard path constraint, and of the bounds of every state.
class PathViolations {
 public:
  /// @param clock  state that is physical time
  PathViolations(const std::vector<model::OcpConstraint>& path, const std::vector<StateBounds>& states,
                 std::optional<std::size_t> clock);

  /// Looks at all rows up to the end of an interval, with its controls.
  void include(const event_integrator::Integration& run, double until);

  /// Returns the largest of all, whatever their units.
  [[nodiscard]] double largest() const;
  /// Returns those that are more than rounding, the largest ones first.
  [[nodiscard]] std::vector<result::PathViolation> list() const;

 private:
  struct Watched {
    std::string name;
    bool is_state = false;
    std::size_t column = 0;  ///< of states, or outputs
    double lower = 0.0, upper = 0.0;
    double value = 0.0, time = 0.0, least = 0.0, most = 0.0;
  };

  std::vector<Watched> watched_;
  std::optional<std::size_t> clock_;
};

}  // namespace saltus::pipeline
