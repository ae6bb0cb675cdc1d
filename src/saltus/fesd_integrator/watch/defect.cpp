#include "saltus/fesd_integrator/watch/defect.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::fesd_integrator {

using discretization::TableauFamily;
using linalg::Index;

Defect::Defect(const ElementSolver& solver) : solver_(solver) {
  const auto& tableau = solver.tableau();
  const auto& c = tableau.c;
  if (tableau.family == TableauFamily::explicit_rk) {
    place_ = 0.5;
    return;
  }
  if (tableau.family == TableauFamily::lobatto_iiic) first_weight_ = std::abs(tableau.b(0));
  if (c(0) == 0.0) place_ = 0.5 * (c(0) + c(1));
  // Coefficients of omega, ascending; Horner's scheme for omega and its integral.
  std::vector<double> omega{1.0};
  for (Index m = 0; m < c.size(); ++m) {
    omega.insert(omega.begin(), 0.0);
    for (std::size_t k = 0; k + 1 < omega.size(); ++k) omega[k] -= c(m) * omega[k + 1];
  }
  const auto value = [&](double theta, bool integral) {
    double sum = 0.0;
    for (std::size_t k = omega.size(); k-- > 0;) {
      sum = sum * theta + omega[k] / (integral ? static_cast<double>(k + 1) : 1.0);
    }
    return integral ? sum * theta : sum;
  };
  constexpr int samples = 200;
  largest_ = 0.0;
  for (int i = 1; i <= samples; ++i) {
    largest_ = std::max(largest_, std::abs(value(static_cast<double>(i) / samples, true)));
  }
  largest_ /= std::abs(value(place_, false));
}

void Defect::errors(const Element& element, const double* f, const double* f_left, std::vector<double>& error) {
  const std::size_t n_x = element.x.size();
  slope_.resize(n_x);
  error.resize(n_x);
  solver_.slope(element, place_, slope_.data());
  for (std::size_t i = 0; i < n_x; ++i) error[i] = element.h * largest_ * std::abs(slope_[i] - f[i]);
  if (first_weight_ == 0.0) return;
  for (std::size_t i = 0; i < n_x; ++i) {
    error[i] = std::max(error[i], element.h * first_weight_ * std::abs(element.stage_slopes[i] - f_left[i]));
  }
}

}  // namespace saltus::fesd_integrator
