// How far from its end sliding is where selections are not determined: surfaces whose gradients depend on each other.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/switching/selections/selection_range.hpp"

namespace saltus::fesd_integrator {

/// Holds f and the derivatives of f and the indicators at a point, as in StageValues; matrices by columns.
struct FieldView {
  const double* f = nullptr;            ///< n_x
  const double* f_selection = nullptr;  ///< n_x by n
  const double* indicator_x = nullptr;  ///< n by n_x
  const double* indicator_t = nullptr;  ///< n
  std::size_t n_x = 0, n = 0;
};

/// Returns the view of TangentValues, and of StageValues that keep all entries.
template <class Values>
[[nodiscard]] FieldView field_view(const Values& at) {
  return {at.f.data(),           at.f_selection.data(), at.indicator_x.data(),
          at.indicator_t.data(), at.f.size(),           at.indicator_t.size()};
}

/// Holds dense matrices of StageValues that keep few entries.
struct DenseMatrices {
  linalg::Matrix f_selection, indicator_x;
};

/// Returns the view of any StageValues; valid as long as these and `memory` are.
[[nodiscard]] FieldView field_view(const discretization::StageValues& at, DenseMatrices& memory);

/// Measures the balances of an active set (ActiveSet::balances). The velocities a + B lambda of a balance are a
/// zonotope, which holds 0 up to one of its facets [ADR 20]. Each selection of a balance stands for some pairs of
/// facets: its margins are the distances from 0 to the nearest of these, for `lower` and `upper`, in units of the
/// zonotope's width.
class SelectionMargins {
 public:
  /// Evaluates the velocities of all balances and the selections in them.
  /// @param at          at the point and `selections`, into which those of the balances enter additively
  /// @param selections  n; those of balances become the ones in the box nearest to 1/2 that hold their surfaces
  /// Cost: B, and a product with the normal of every facet; facets are found again where B has changed.
  void evaluate(const ActiveSet& set, const FieldView& at, double* selections);
  /// Returns, behind evaluate(), the value of a condition of a selection in a balance: >= 0 while it holds.
  [[nodiscard]] double value(const Condition& condition) const;
  /// Returns what its value depends on near by: the sum of normal_k d/dt (surface k) at the selections there, up to a
  /// factor; one entry per sliding surface, 0 for those that are in no balance with it.
  [[nodiscard]] std::vector<double> normal(const ActiveSet& set, const Condition& condition) const;

 private:
  struct Margin {
    double value = 0.0;
    std::size_t balance = 0, facet = 0;
  };

  std::vector<switching::SelectionRange> ranges_;
  std::vector<Margin> lower_, upper_;  ///< n
};

/// Gives a set its balances, in which step selections slide on surfaces whose gradients depend on each other. It gives
/// none if some surfaces are moved by none of them, or some selections move the state that are in none.
/// @param at  at any selections, which enter additively
/// @return whether it has some now
[[nodiscard]] bool find_balances(const FieldView& at, ActiveSet& set);

}  // namespace saltus::fesd_integrator
