#include <algorithm>

#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/element_polynomial_internal.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::fesd_integrator {

using linalg::Index;

ElementPolynomial::ElementPolynomial(const discretization::ButcherTableau& tableau) {
  const Index s = tableau.stages();
  hermite_ = tableau.family == discretization::TableauFamily::explicit_rk;
  last_node_ = tableau.c(s - 1);
  stages_on_polynomial_ = tableau.is_collocation();
  if (!hermite_) {
    linalg::Matrix powers(s, s);  // of the nodes
    for (Index i = 0; i < s; ++i) {
      double power = 1.0;
      for (Index k = 0; k < s; ++k, power *= tableau.c(i)) powers(i, k) = power;
    }
    integrals_ = linalg::FullLu(powers).inverse();
    for (Index k = 0; k < s; ++k) integrals_.row(k) /= static_cast<double>(k + 1);
  }
  const auto add = [&](double theta, int stage) {
    watch_points_.push_back(theta);
    watch_stage_.push_back(stage);
  };
  add(0.0, -1);
  if (stages_on_polynomial_) {
    for (Index m = 0; m < s; ++m) {
      if (tableau.c(m) > 0.0 && tableau.c(m) < 1.0) add(tableau.c(m), static_cast<int>(m));
    }
    if (watch_points_.size() == 1) add(0.5, -3);  // a polynomial of degree 2 could turn back unseen
  } else {
    for (const double theta : {0.25, 0.5, 0.75}) add(theta, -3);
  }
  add(1.0, -2);
}

double ElementPolynomial::weight(Index stage, double theta) const {
  double sum = 0.0;
  for (Index k = integrals_.rows(); k-- > 0;) sum = (sum + integrals_(k, stage)) * theta;
  return sum;
}

void ElementPolynomial::evaluate(const Element& element, double theta, double* x) const {
  const std::size_t n_x = element.x.size();
  if (n_x == 0) return;
  const std::size_t n_s = element.stage_slopes.size() / n_x;
  const double* slopes = element.stage_slopes.data();
  if (hermite_) {
    const double along = theta * theta * (3.0 - 2.0 * theta);
    const double left = theta * (1.0 - theta) * (1.0 - theta), right = -theta * theta * (1.0 - theta);
    const double stretch = last_node_ > 0.0 ? 1.0 / last_node_ : 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      const double end_slope = slopes[i] + stretch * (slopes[(n_s - 1) * n_x + i] - slopes[i]);
      x[i] =
          element.x[i] + along * (element.end[i] - element.x[i]) + element.h * (left * slopes[i] + right * end_slope);
    }
    return;
  }
  std::copy(element.x.begin(), element.x.end(), x);
  for (std::size_t m = 0; m < n_s; ++m) {
    const double factor = element.h * weight(static_cast<Index>(m), theta);
    for (std::size_t i = 0; i < n_x; ++i) x[i] += factor * slopes[m * n_x + i];
  }
}

double ElementPolynomial::weight_of_slope(Index stage, double theta) const {
  double sum = 0.0;
  for (Index k = integrals_.rows(); k-- > 0;) sum = sum * theta + static_cast<double>(k + 1) * integrals_(k, stage);
  return sum;
}

void ElementPolynomial::slope(const Element& element, double theta, double* slope) const {
  const std::size_t n_x = element.x.size();
  if (n_x == 0) return;
  const std::size_t n_s = element.stage_slopes.size() / n_x;
  const double* slopes = element.stage_slopes.data();
  if (hermite_) {
    const double along = 6.0 * theta * (1.0 - theta) / element.h;
    const double left = (1.0 - theta) * (1.0 - 3.0 * theta), right = theta * (3.0 * theta - 2.0);
    const double stretch = last_node_ > 0.0 ? 1.0 / last_node_ : 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      const double end_slope = slopes[i] + stretch * (slopes[(n_s - 1) * n_x + i] - slopes[i]);
      slope[i] = along * (element.end[i] - element.x[i]) + left * slopes[i] + right * end_slope;
    }
    return;
  }
  std::fill_n(slope, n_x, 0.0);
  for (std::size_t m = 0; m < n_s; ++m) {
    const double factor = weight_of_slope(static_cast<Index>(m), theta);
    for (std::size_t i = 0; i < n_x; ++i) slope[i] += factor * slopes[m * n_x + i];
  }
}

void ElementPolynomial::watch_state(const Element& element, std::size_t point, double* x) const {
  const int stage = watch_stage_[point];
  const std::size_t n_x = element.x.size();
  if (stage >= 0) {
    std::copy_n(element.stage_states.data() + static_cast<std::size_t>(stage) * n_x, n_x, x);
  } else if (stage == -1) {
    std::copy(element.x.begin(), element.x.end(), x);
  } else if (stage == -2) {
    std::copy(element.end.begin(), element.end.end(), x);
  } else {
    evaluate(element, watch_points_[point], x);
  }
}

}  // namespace saltus::fesd_integrator
