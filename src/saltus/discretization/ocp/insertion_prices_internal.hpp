// What an element that is inserted with length zero does to the objective, by the multipliers of a branch.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"

namespace saltus::discretization {

/// Holds where an element is inserted.
struct Insertion {
  std::size_t before = 0;           ///< the element that follows, or one behind the last
  std::size_t interval = 0;         ///< of that element or of the one before it
  const std::vector<double>& left;  ///< what is left of it: that of the boundary, or behind impacts there
  const ElementSides::Sides& modes;
  linalg::Vector own;   ///< its variables, solved
  double length = 0.0;  ///< small
};

/// Finds reduced costs of lengths of elements that are not there: dL/dh at h = 0+ with L = f + rows'g, the mode
/// insertion gradient p'(f_m - f_i) + L_m - L_i of a discretised problem. Negative: the objective falls with the
/// element. Adjoints p of the new element's right end are those of the boundary, its own multipliers follow from them.
class InsertionPrices {
 public:
  /// @param branch  with multipliers
  explicit InsertionPrices(const SolvedBranch& branch);
  /// Returns what the element and a jump before it change of the objective, to first order: p'(left - boundary) and its
  /// length times the reduced cost. Infinite where no multipliers of the element agree with the adjoints: what follows
  /// asks for a surface that it leaves. Nothing where lengths are fixed.
  /// Cost: a few local Jacobians and one small least-squares solution.
  [[nodiscard]] std::optional<double> price(const Insertion& at) const;

 private:
  struct CopyOf {
    const Placed* placed = nullptr;
    std::size_t number = 0;
  };
  /// Returns dL/d(state, time, multipliers) at the right end of the new element, of all that follows.
  [[nodiscard]] linalg::Vector adjoint(const Insertion& at) const;
  /// Adds what copies have of their local variables `first` to `first + slopes.size()`.
  void add_slopes(const std::vector<CopyOf>& copies, int first, linalg::View slopes) const;
  /// Adds rows of a function at z with their multipliers, and the objective.
  void add_slopes(LocalFunction& function, const double* z, mpcc::ConstVectorView multipliers, int first,
                  linalg::View slopes) const;
  [[nodiscard]] std::optional<double> multiplier_of_sum(std::size_t interval) const;

  const OcpStructure& made_;
  const ElementSides& modes_;
  mpcc::ConstVectorView w_;
  mpcc::ConstVectorView rows_;
  ElementTrial trial_;
  std::vector<std::vector<CopyOf>> within_;   ///< per element: what depends on its left end
  std::vector<std::vector<CopyOf>> at_node_;  ///< per element: what is asked where it ends an interval
};

}  // namespace saltus::discretization
