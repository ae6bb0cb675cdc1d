// The state between the ends of an element.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

struct Element;

/// Evaluates the collocation polynomial x(t + theta h) = x_0 + h sum_m B_m(theta) f_m, eq. (46) of [nurkanovic2024].
/// B_m is the integral of the m-th Lagrange polynomial of the nodes c. The nodes of explicit methods coincide: of these
/// it is the cubic through both ends. It has the slope at the first end, and at the second the one that the first and
/// last stage continue to.
class ElementPolynomial {
 public:
  explicit ElementPolynomial(const discretization::ButcherTableau& tableau);
  void evaluate(const Element& element, double theta, double* x) const;
  /// Evaluates d x / dt there.
  void slope(const Element& element, double theta, double* slope) const;
  [[nodiscard]] const std::vector<double>& watch_points() const { return watch_points_; }
  void watch_state(const Element& element, std::size_t point, double* x) const;

 private:
  [[nodiscard]] double weight(linalg::Index stage, double theta) const;
  [[nodiscard]] double weight_of_slope(linalg::Index stage, double theta) const;

  bool hermite_ = false;
  double last_node_ = 1.0;
  bool stages_on_polynomial_ = false;
  linalg::Matrix integrals_;  ///< coefficients of theta, theta^2, …; one column per stage
  std::vector<double> watch_points_;
  std::vector<int> watch_stage_;  ///< -1 left end, -2 right end, -3 somewhere else
};

}  // namespace saltus::fesd_integrator
