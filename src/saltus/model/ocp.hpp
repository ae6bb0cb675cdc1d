// An optimal control problem as a value: a system, and over its symbols what is minimised and constrained.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/ocp_description.hpp"
#include "saltus/model/ocp_terms.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// States an optimal control problem:
///   min  int L dt + E(x(T), T, p) + w T + least squares + penalties
///   over u_k (one per interval), free T, free x_i(from) and free p
///   subject to xdot = f(t, x, u, p, alpha), bounds, path and terminal constraints and complementarities.
/// Every expression is an output of `system`: L, E, constraints.
struct Ocp {
  /// Controls: the user's, then one per kink of controls; outputs: the user's, those of the problem, others.
  System system;
  int user_controls = 0, user_outputs = 0, problem_outputs = 0;
  /// Controls that are slacks of kinks of states and controls in the running cost: a value per stage.
  std::vector<int> stage_slacks;
  double from = 0.0;
  OcpHorizon horizon;
  std::optional<int> running_cost, terminal_cost;  ///< outputs
  std::vector<OcpConstraint> path, terminal;
  ConstraintPoints path_at = ConstraintPoints::intervals;
  std::vector<std::pair<int, int>> complementarities;  ///< outputs
  std::vector<OcpLeastSquares> least_squares;
  std::vector<bool> free_states;                         ///< one per state
  std::vector<bool> free_parameters;                     ///< one per parameter
  std::vector<double> parameter_lower, parameter_upper;  ///< of free ones; else the value
  /// What initial(q) is in terminal costs and constraints: parameters that no result shows.
  std::vector<OcpInitialValue> initial_values;
  OcpGuesses guess;
  std::optional<OcpClock> clock;
  /// With contacts or hysteresis `system` is frozen, and this is what it stands for, with the same outputs: the states
  /// that a result shows come first.
  std::shared_ptr<const System> physical;
  /// What the closed loop simulates instead: `physical`, or `system` without, with other parameters and initial values.
  std::shared_ptr<const System> plant;
  std::vector<std::string> warnings;
  std::map<std::string, SourceLocation> places;  ///< of switching functions and cells whose expression is known

  [[nodiscard]] bool is_initial_value(std::size_t parameter) const {
    for (const auto& one : initial_values) {
      if (static_cast<std::size_t>(one.parameter) == parameter) return true;
    }
    return false;
  }
};

/// Builds the problem a description states, with the overrides applied.
/// @return the problem, or the first error with file, line, column and remedy.
[[nodiscard]] Expected<Ocp> build_ocp(const Description& description, const std::vector<Override>& overrides = {});

/// Builds the system with piecewise constant controls: u = values[k] from times[k] on, the first one before.
/// @param times  ascending
/// @param values  one row per time, one column per control
[[nodiscard]] System with_controls(System system, const std::vector<double>& times,
                                   const std::vector<std::vector<double>>& values);

}  // namespace saltus::model
