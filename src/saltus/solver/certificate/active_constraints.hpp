// Which bounds and rows of a branch problem hold with equality at its solution, and whether their gradients depend on
// each other.
#pragma once

#include <vector>

#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/solver/crossover/branch.hpp"

namespace saltus::solver::crossover {
struct Symmetric;
}

namespace saltus::solver::certificate {

/// Says which bound is reached; `both`: they are equal.
enum class At { none, lower, upper, both };

struct ActiveRow {
  int row;  ///< of (g, G, H) of the whole problem
  At at;
  double multiplier;  ///< as of NlpPoint::y
};

struct ActiveConstraints {
  std::vector<At> bounds;       ///< of each variable of the branch problem
  std::vector<ActiveRow> rows;  ///< those without a variable of the branch problem are not among them
  std::vector<ActiveRow> held;  ///< those of g that the user states and all of whose variables are held

  /// Leaves out rows and bounds that are inequalities with a multiplier of at most `zero`.
  [[nodiscard]] ActiveConstraints strongly(const NlpPoint& point, double zero) const;
};

/// Finds those at a solution of a branch problem; what is within the tolerance of a bound, relative to it, is at it.
[[nodiscard]] ActiveConstraints find_active(mpcc::Problem& problem, crossover::Branch& branch, double tolerance);

/// Holds the gradients of active rows in the variables that no active bound holds, each divided by its length.
struct ActiveGradients {
  std::vector<int> column;       ///< of each variable of the branch problem; -1 if a bound holds it
  linalg::SparseColumns matrix;  ///< such variables (at least one row) x active rows
  std::vector<double> size;      ///< length of each gradient; 1 where it is zero

  [[nodiscard]] int variables() const;
};
[[nodiscard]] ActiveGradients gradients_of(const ActiveConstraints& active, const crossover::Reduction& reduction,
                                           const RowMatrix& jacobian);

/// Returns whether they surely do not depend on each other: no singular value is below a millionth. It is so if
///   [I J'; J d^2 I],  d = 1e-6,
/// has as many negative eigenvalues as J rows. Cost: one sparse factorisation.
[[nodiscard]] bool are_independent(const ActiveGradients& gradients);

/// Returns whether a symmetric matrix has the inertia (size - rows, rows, 0); its last `rows` lines are constraints.
/// Cost: one sparse factorisation.
[[nodiscard]] bool has_saddle_inertia(const crossover::Symmetric& system, int rows);

/// Gradients of length 1 that are nearer than this to a combination of others depend on them.
inline constexpr double dependence = 1e-8;

}  // namespace saltus::solver::certificate
