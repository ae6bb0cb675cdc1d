// All multipliers of a branch problem at its solution, where there are more than one.
#pragma once

#include <optional>
#include <vector>

#include "saltus/linalg/sparse.hpp"
#include "saltus/solver/certificate/active_constraints.hpp"
#include "saltus/solver/lpcc_solver.hpp"

namespace saltus::solver::certificate {

/// Holds the least and the greatest value that a multiplier can have; infinite where it has no limit.
struct MultiplierRange {
  double lower = 0.0, upper = 0.0;
  [[nodiscard]] bool is_unique() const;
};

/// Holds a multiplier of every point of the set: value + change't.
struct SideMultiplier {
  double value = 0.0;
  std::vector<double> change;
  int owner = 0;  ///< of the sign that an active inequality gives it
};

/// States lower <= multiplier <= upper.
struct MultiplierCondition {
  const SideMultiplier* multiplier;
  double lower, upper;
};

/// The multipliers y, z of grad f + J'y - z = 0 at a solution of a branch problem. Those of variables and rows at no
/// bound are zero, those of inequalities have their sign. Where gradients of active constraints depend on each other
/// they are a polyhedron: those of one point, and what is added to them, V t. The least value in it is the slope of the
/// optimal objective where the constraint moves in one direction, the greatest in the other. Without a limit the branch
/// has no solution in that direction.
class MultiplierSet {
 public:
  /// Cost: one sparse factorisation of the active gradients, and a QR one where they may depend on each other.
  /// @param active  of find_active
  MultiplierSet(mpcc::Problem& problem, crossover::Branch& branch, ActiveConstraints active);

  [[nodiscard]] const ActiveConstraints& active() const { return active_; }
  /// Whether they are a single point.
  [[nodiscard]] bool is_unique() const { return dependent_rows() == 0 && active_.held.empty(); }
  /// The number of active rows that depend on others and on active bounds.
  [[nodiscard]] int dependent_rows() const { return static_cast<int>(vectors_.cols()); }
  /// Rows of (g, G, H) that take part in that, in increasing order.
  [[nodiscard]] std::vector<int> rows_that_depend() const;

  /// Of the row of g; positive where the upper bound presses. Cost: two linear programs where it is not unique.
  [[nodiscard]] MultiplierRange of_row(int row, LpccSolver& linear) const;
  /// Of the bounds of a variable of the whole problem, upper - lower.
  [[nodiscard]] MultiplierRange of_bounds(int variable, LpccSolver& linear) const;
  /// Of side `row` of (g, G, H) at a pair, >= 0 where it is an active inequality; nullopt if it has none of its own:
  /// the bounds of several variables, or of one that other sides have, too.
  [[nodiscard]] std::optional<SideMultiplier> of_side(mpcc::Problem& problem, int row) const;
  /// Returns whether some multipliers fulfil the conditions. The signs of `freed` owners are not asked for.
  /// Cost: one linear program.
  [[nodiscard]] bool can_have(const std::vector<MultiplierCondition>& conditions, const std::vector<int>& freed,
                              LpccSolver& linear) const;

 private:
  void find_slopes(mpcc::Problem& problem, const crossover::Branch& branch, const RowMatrix& jacobian);
  void add_signs(const crossover::Reduction& reduction);
  [[nodiscard]] MultiplierRange range(double value, const std::vector<double>& change, LpccSolver& linear) const;

  ActiveConstraints active_;
  linalg::SparseRows vectors_;              ///< V: active rows x dimensions
  std::vector<int> leader_;                 ///< of each variable of the problem: the one that stands for it
  linalg::Vector slope_;                    ///< grad f + J'y, of each variable; of equal ones with their leader
  linalg::SparseRows slope_change_;         ///< J'V, likewise
  std::vector<std::vector<double>> signs_;  ///< signs_[i] t >= least_[i]
  std::vector<double> least_;
  std::vector<int> owners_;  ///< of signs_: a row, or ~leader of variables
  RowMatrix jacobian_;
};

}  // namespace saltus::solver::certificate
