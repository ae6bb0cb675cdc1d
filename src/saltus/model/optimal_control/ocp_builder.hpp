// An optimal control problem stated in C++, in CasADi expressions.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::model {

/// Says how a constraint is held: hard, or by `penalty` times a norm of its violations in the objective.
struct Softness {
  ConstraintNorm norm = ConstraintNorm::hard;
  double penalty = 0.0;
};

/// Builds an Ocp over the symbols of a Builder; names, rules and errors are those of the table [optimize].
///
///   Builder model("block");
///   const SX q = model.state("q", {0}), v = model.state("v", {0}), u = model.control("u", {0, -2, 2});
///   model.dynamics("q", v);
///   model.dynamics("v", u - model.sign(v));
///   OcpBuilder problem(std::move(model));
///   problem.free_horizon(3, 0.1, 10);
///   problem.minimize_time();
///   problem.terminal_constraint("q == 1", 1, q, 1);
///   problem.terminal_constraint("v == 0", 0, v, 0);
///   Expected<Ocp> ocp = problem.build();
///
/// Expressions are scalar. The first mistake is kept and returned by build().
class OcpBuilder {
 public:
  /// @param system  finished: its symbols stay valid
  explicit OcpBuilder(Builder system);
  ~OcpBuilder();
  OcpBuilder(OcpBuilder&&) noexcept;
  OcpBuilder& operator=(OcpBuilder&&) noexcept;

  /// Sets the time that the problem begins at; 0 by default.
  void start_time(double from);
  void horizon(double length);  ///< positive
  void free_horizon(double initial, double lower, double upper);
  /// Adds weight T to the objective.
  void minimize_time(double weight = 1.0);
  void running_cost(const casadi::SX& cost);   ///< L(t, x, u, p), integrated
  void terminal_cost(const casadi::SX& cost);  ///< E(x(T), T, p)
  /// Adds r'W r with r = of - reference, summed over the points.
  /// @param reference  expressions of time and parameters, one each; empty: 0
  /// @param weight  symmetric, n x n; 0 x 0 for the identity
  void least_squares(const std::vector<casadi::SX>& of, const std::vector<casadi::SX>& reference = {},
                     const linalg::Matrix& weight = {}, CostPoints at = CostPoints::intervals);
  /// Adds the sum of r'W r with r = of - samples over measurements, in a horizon that is fixed.
  /// @param times  ascending, within the horizon
  /// @param samples  one row per time, one column per expression
  /// @param weight  as in least_squares
  void measurements(const std::vector<casadi::SX>& of, const std::vector<double>& times, const linalg::Matrix& samples,
                    const linalg::Matrix& weight = {});
  /// Adds lower <= e <= upper; one of them may be infinite.
  void path_constraint(const std::string& name, double lower, const casadi::SX& e, double upper,
                       const Softness& soft = {});
  void path_constraints_at(ConstraintPoints points);
  void terminal_constraint(const std::string& name, double lower, const casadi::SX& e, double upper,
                           const Softness& soft = {});
  /// Adds 0 <= a _|_ b >= 0 along the path.
  void complementarity(const casadi::SX& a, const casadi::SX& b);
  /// Returns the value of a state at the start of the horizon, for terminal costs and constraints:
  /// terminal_constraint("q == initial(q)", 0, q - problem.initial("q"), 0) states a periodic problem.
  [[nodiscard]] casadi::SX initial(const std::string& state);
  /// Lets the initial value be chosen between the bounds of the state.
  void free_state(const std::string& name);
  void free_parameter(const std::string& name, double lower, double upper);
  /// Says where the solution of a state, a control or a free parameter is looked for first: an expression of time and
  /// parameters.
  void guess(const std::string& name, const casadi::SX& e);

  /// @return the problem, or the first mistake.
  [[nodiscard]] Expected<Ocp> build();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saltus::model
