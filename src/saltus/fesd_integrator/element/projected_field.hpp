// The motion in an active set at a point, without an element: selections that keep the surfaces at zero.
#pragma once

#include <memory>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"

namespace saltus::fesd_integrator {

/// Solves d/dt (surfaces of the set) = 0 along f for the selections that slide,
///   surface_x f(t, x, alpha) + surface_t = 0,
/// by Newton's method from the values it is handed (steps of least norm where they are not unique).
/// Why: these are functions of the point alone, as accurate as x is, where the stages' own are of the lower order of an
/// index-2 variable; so the end of sliding is found with the order of the method.
class ProjectedField {
 public:
  /// The kernel must outlive it.
  explicit ProjectedField(const discretization::StageKernel& kernel);
  ProjectedField(ProjectedField&&) noexcept;
  ~ProjectedField();

  /// Solves for the selections that slide.
  /// @param selections  all of them; the sliding ones are found
  /// @param rounding    of the state per time: rates that no selection changes are zero within it
  /// @return false where Newton's method finds none. values() are those at the solution.
  [[nodiscard]] bool solve(double t, const double* x, const ActiveSet& set, const double* held, double* selections,
                           double rounding = 0.0);
  /// Returns the rounding of rates for states of this size behind elements of length h. Their equations hold psi = 0,
  /// and so d psi / dt, to that.
  [[nodiscard]] static double rounding_of_rates(double size, double h) { return 1e-12 * size / h; }
  /// Returns whether the equations of the last solve() have one solution.
  [[nodiscard]] bool regular() const { return regular_; }
  /// Returns whether the k-th selection that slides is in none of them: it follows from a higher derivative of its
  /// surface.
  [[nodiscard]] bool in_no_equation(std::size_t k) const { return in_no_equation_[k]; }
  /// Gives those of `selections` that are in no equation the values they have in `known` (n_selections each).
  void take_undetermined(const ActiveSet& set, const double* known, double* selections) const;
  /// Evaluates values() at selections that are known.
  void evaluate(double t, const double* x, const double* held, const double* selections) {
    kernel_.evaluate(t, x, selections, held, values_);
  }
  [[nodiscard]] const discretization::StageValues& values() const { return values_; }
  /// Evaluates the rates d psi / dt (or d g / dt) of all indicators along values().f.
  void rates(std::vector<double>& rate) const;

 private:
  /// Of what the equations consist: the largest term of a rate, the largest component of a gradient.
  struct Sizes {
    double terms = 0.0, gradients = 0.0;
  };
  Sizes form_equations(const ActiveSet& set);
  Sizes form_entries(const ActiveSet& set);

  const discretization::StageKernel& kernel_;
  discretization::StageValues values_;
  bool regular_ = true;
  std::vector<bool> in_no_equation_;
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace saltus::fesd_integrator
