// One finite element: the Runge-Kutta equations of a dynamic complementarity system in a given active set.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/time_warp.hpp"

namespace saltus::fesd_integrator {

/// Says where an element begins: time, state, and the selections there in its own active set.
struct Point {
  double t = 0.0;
  std::vector<double> x;           ///< n_x
  std::vector<double> selections;  ///< all, the limit from the right
  double size = 0.0;               ///< of the states around: what roundings are relative to
};

/// Holds a solved element. Columns of matrices are stages.
struct Element {
  double t = 0.0;  ///< left end
  double h = 0.0;
  double size = 0.0;      ///< what roundings are relative to: the largest state, the terms of h f that cancel
  std::vector<double> x;  ///< left end
  std::vector<double> stage_states;      ///< n_x by n_s
  std::vector<double> stage_slopes;      ///< n_x by n_s: f at the stages, times d phi / d tau of the warp
  std::vector<double> stage_selections;  ///< n_selections by n_s
  std::vector<double> end;               ///< n_x: right end, on the surfaces that slide
  TimeWarp warp;                         ///< input: the method's steps are those of tau
};

/// Solves, for given h and one active set per stage,
///   x_m = x_0 + h sum_l a_ml f(t_l, x_l, alpha_l),   surfaces of the set of stage m = 0 at x_m,   m = 1 ... n_s
/// for x_m and the selections that slide. Within an element of FESD all sets are the same, (37) of [nurkanovic2024];
/// without switch detection each stage has its own. Exceptions:
///   c_s != 1, one set: the end is projected, x_1 = x_0 + h sum_l b_l f_l + f_alpha mu, surfaces = 0 at x_1;
///   Lobatto IIIA: the selections of the first stage are those of the element's left end, they are in no equation;
///   explicit methods, one set: the surfaces are zero at the stage after, behind the last at the end (half-explicit).
/// Functions that rest are zero at the end, too (RestProjection).
/// With a warp t_l = t_0 + h phi(c_l), and f(t_l, ...) comes with the factor phi'(c_l); the nodes are those of tau.
///
/// Newton's method with exact derivatives, to rounding; steps of least norm where the selections are not unique.
/// No allocation in solve() once elements have their size, where nothing rests. One solver per thread.
class ElementSolver {
 public:
  /// The kernel must outlive the solver.
  ElementSolver(const discretization::StageKernel& kernel, discretization::ButcherTableau tableau);
  ElementSolver(ElementSolver&&) noexcept;
  ElementSolver& operator=(ElementSolver&&) noexcept;
  ~ElementSolver();

  enum class Outcome { solved, not_converged, not_finite };
  /// Solves the element. `sets`: one, or one per stage. `held`: values of Dcs::held. The stage values in `element` are
  /// the first guess with `stages`, else the left end or those of Euler's method (`field`, and with roots, whose
  /// derivatives are infinite where they are 0). Cost: n_Newton (n_s evaluations + (n_s (n_x + n_sliding))^3 / 3).
  enum class Guess { left_end, field, stages };
  [[nodiscard]] Outcome solve(const Point& left, double h, std::span<const ActiveSet> sets, const double* held,
                              Guess guess, Element& element);
  /// Returns whether the states of the last solve() are the only ones in their set: false where selections move them
  /// that no equation holds (four regions that meet have four weights and three equations in Stewart's form).
  /// Selections that are determined by a higher derivative of their surface are. Cost: n^3 where the matrix was
  /// singular.
  [[nodiscard]] bool determined() const;
  /// Evaluates x(t + theta h), theta a part of the time: for collocation and Lobatto methods the polynomial of degree
  /// n_s with the slopes of the stages, eq. (46) of [nurkanovic2024]; for explicit ones the cubic through both ends
  /// with the slopes there.
  void interpolate(const Element& element, double theta, double* x) const;
  /// Evaluates d x / d (tau h) of the same.
  void slope(const Element& element, double tau, double* slope) const;
  /// Finds the stage values of the element behind `element`, neither warped, continued along its polynomial.
  void extrapolate(const Element& element, double h, Element& next) const;

  /// Returns the ascending tau in [0, 1], both ends among them, where signs are looked at, and the states there.
  [[nodiscard]] const std::vector<double>& watch_points() const;
  void watch_state(const Element& element, std::size_t point, double* x) const;
  /// Returns the stage at such a point, -1 if there is none.
  [[nodiscard]] int watch_stage(std::size_t point) const;

  [[nodiscard]] const discretization::ButcherTableau& tableau() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::fesd_integrator
