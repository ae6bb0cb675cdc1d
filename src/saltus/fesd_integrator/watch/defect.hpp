// How far the polynomial of an element is from a solution.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/projected_field.hpp"

namespace saltus::fesd_integrator {

/// Measures the defect d(theta) = u'(theta) - f(u(theta)) of an element's polynomial u at one point theta_c. There the
/// method does not ask for it to be zero. Of collocation methods it is d(theta_c) omega(theta) / omega(theta_c) to
/// leading order, omega(theta) = prod_m (theta - c_m), so that
///   u(theta) - x(theta) ~ h d(theta_c) W(theta) / omega(theta_c),   W(theta) = int_0^theta omega.
/// Of other methods d is taken as constant. Lobatto IIIA and IIIC have a node at 0: of IIIC the stage there is not the
/// left end, and the difference of slopes is another error, with the weight of that stage. theta_c = 0 where no node is
/// there: f at the left end is known anyway.
class Defect {
 public:
  /// The solver must outlive it.
  explicit Defect(const ElementSolver& solver);

  /// Returns where f is wanted.
  [[nodiscard]] double place() const { return place_; }
  /// Finds max over theta of |u(theta) - x(theta)| by component, from f at the place and at the left end.
  /// @param f, f_left, error  n_x
  void errors(const Element& element, const double* f, const double* f_left, std::vector<double>& error);

 private:
  const ElementSolver& solver_;
  double place_ = 0.0;
  double largest_ = 1.0;  ///< of |W / omega(theta_c)|
  double first_weight_ = 0.0;
  std::vector<double> slope_;
};

}  // namespace saltus::fesd_integrator
