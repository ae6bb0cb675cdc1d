#include "saltus/mpcc/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::mpcc {
namespace {

/// Like std::max, but NaN wins.
void raise(double& largest, double value) {
  if (!std::isnan(largest) && !(value <= largest)) largest = value;
}

void raise_by_violation(double& largest, ConstVectorView values, const Bounds& bounds) {
  for (linalg::Index i = 0; i < values.size(); ++i) {
    // NaN compares false with everything: it has to reach `raise`.
    raise(largest, values[i] - bounds.upper[i]);
    raise(largest, bounds.lower[i] - values[i]);
  }
}

}  // namespace

double Residuals::infeasibility() const {
  double largest = primal_infeasibility;
  raise(largest, complementarity_residual);
  return largest;
}

Residuals residuals(Problem& problem, ConstVectorView w) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  Residuals result;
  raise_by_violation(result.primal_infeasibility, w, problem.variable_bounds());
  raise_by_violation(result.primal_infeasibility, c.head(n_g), problem.constraint_bounds());
  for (int i = 0; i < pairs; ++i) {
    const double G = c[n_g + i];
    const double H = c[n_g + pairs + i];
    raise(result.primal_infeasibility, -G);
    raise(result.primal_infeasibility, -H);
    raise(result.complementarity_residual, std::min(std::abs(G), std::abs(H)));
    raise(result.complementarity_product, std::abs(G * H));
  }
  return result;
}

std::vector<ActiveSide> active_sides(Problem& problem, ConstVectorView w, double tolerance) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  std::vector<ActiveSide> sides;
  sides.reserve(static_cast<std::size_t>(pairs));
  for (int i = 0; i < pairs; ++i) {
    const bool G_is_zero = std::abs(c[n_g + i]) <= tolerance;
    const bool H_is_zero = std::abs(c[n_g + pairs + i]) <= tolerance;
    sides.push_back(G_is_zero ? (H_is_zero ? ActiveSide::biactive : ActiveSide::G)
                              : (H_is_zero ? ActiveSide::H : ActiveSide::none));
  }
  return sides;
}

}  // namespace saltus::mpcc
