// From a relaxed point to the branch that it leads to.
#pragma once

#include <optional>
#include <vector>

#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {

/// Says how good the relaxed point is that a branch is tried from.
struct RelaxedPoint {
  const linalg::Vector& w;
  double sigma = 1.0;
  bool is_of_loop = false;  ///< solved in one loop, and nearer to its solution than a problem that is solved by itself
  bool is_last = false;     ///< no better one will come
};

/// Tries the branch problem of the sides that are smaller at a relaxed point, where it is worth its solution.
class Crossing {
 public:
  explicit Crossing(Run& run) : run_(run) {}

  /// True if the branch is good enough: run.branch is it then, unless another path has found it. Else it is
  /// run.refused, if it is feasible and the best of these.
  bool cross(const RelaxedPoint& point);
  /// Tries the branch of the motion of controls in the same way.
  /// @param relaxed  point that it is compared with; null: there is none, and it is only kept as run.refused
  bool try_motion(mpcc::ConstVectorView controls, const linalg::Vector* relaxed);
  /// Returns how many points in a row had sides whose branch was refused.
  [[nodiscard]] int same_refused() const { return same_refused_; }
  [[nodiscard]] double refused_objective() const { return refused_objective_; }  ///< of that branch
  /// Returns whether a branch was refused that costs what the best branch of paths before does.
  [[nodiscard]] bool leads_to_found() const { return leads_to_found_; }
  [[nodiscard]] static double slack(double objective);  ///< how much worse than the relaxed point a branch may be

 private:
  [[nodiscard]] bool is_worth_trying(const RelaxedPoint& point, const linalg::Vector& c) const;
  [[nodiscard]] bool is_solved(const crossover::Branch& branch, const linalg::Vector& w) const;
  bool take(crossover::Branch branch, const linalg::Vector* relaxed);
  [[nodiscard]] bool is_good(double objective, const linalg::Vector& w) const;
  bool accept_known(const std::vector<mpcc::ActiveSide>& sides, double objective, const linalg::Vector& w);
  bool solve(const RelaxedPoint& point, const std::vector<mpcc::ActiveSide>& sides);

  Run& run_;
  int same_refused_ = 0;
  double refused_objective_ = 0.0;
  bool leads_to_found_ = false;
  std::optional<std::vector<mpcc::ActiveSide>> infeasible_sides_;
  double infeasible_sigma_ = 0.0;
};

}  // namespace saltus::solver
