// What is left of a problem when one side of each pair is fixed.
#pragma once

#include <vector>

#include "saltus/mpcc/problem.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::solver::crossover {

/// Says why a variable is none of the branch problem.
enum class Hold {
  free,     ///< it is one
  bounds,   ///< its bounds are equal
  side,     ///< it belongs to the zero side of a pair
  closure,  ///< mpcc::BranchClosure says so
};

/// Says where the variables and rows of a problem stand in its branch problem. Sides fix variables instead of adding
/// rows: with full cross complementarity rows would be more than variables.
struct Reduction {
  std::vector<int> place;   ///< of each variable; -1 if it is held. Equal ones have the same place
  std::vector<Hold> hold;   ///< of each variable
  linalg::Vector value;     ///< of each variable that is held
  std::vector<int> leader;  ///< the variable that each place has its name from
  mpcc::Bounds bounds;      ///< of each place
  std::vector<int> rows;    ///< of (g, G, H) that are left
  mpcc::Bounds row_bounds;

  [[nodiscard]] int variables() const { return static_cast<int>(leader.size()); }
  [[nodiscard]] int equations() const;
};

/// Says whether what a branch leaves open is fixed (BranchClosure::Freedom).
enum class Closing { whole, with_freedom };

/// @param sides     of each pair: which is zero; `biactive` both, `none` leaves the pair out, as group -1 does
/// @param jacobian  dc/dw at a point: signs of implied sides, and which constrained sides are one and the same
/// @param c         values of (g, G, H) at that point
[[nodiscard]] Reduction reduce(const mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides,
                               const RowMatrix& jacobian, const linalg::Vector& c, Closing closing = Closing::whole);

}  // namespace saltus::solver::crossover
