#include "saltus/switching/selections/selection_complementarity.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/linalg/spectra.hpp"
#include "saltus/switching/point/point_solver.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// lambda as z of boxes, with -y for y; in the middle where nothing is found.
Vector lambda_in_boxes(const Matrix& effects, const Vector& constant) {
  const Matrix against = -1.0 * effects;
  const Vector start = -1.0 * constant;
  PointProblem problem{{}, against, start, start.max_abs()};
  for (Index i = 0; i < constant.size(); ++i) {
    problem.blocks.push_back({.kind = Block::Kind::box, .row = static_cast<int>(i)});
  }
  const auto found = solve_point(problem, {}).all;
  const auto better = [](const PointSolution& a, const PointSolution& b) { return a.margin < b.margin; };
  const auto best = std::max_element(found.begin(), found.end(), better);
  return best == found.end() ? Vector::constant(constant.size(), 0.5) : best->z;
}

/// A positive diagonal D with D W symmetric; false if there is none.
bool symmetrise(const Matrix& effects, Vector& scale) {
  const Index m = effects.rows();
  scale.set_zero(m);
  const double tiny = 1e-9 * effects.max_abs();
  for (Index start = 0; start < m; ++start) {
    if (scale[start] != 0.0) continue;
    scale[start] = 1.0;
    std::vector<Index> open{start};
    while (!open.empty()) {
      const Index i = open.back();
      open.pop_back();
      for (Index j = 0; j < m; ++j) {
        if (i == j || std::abs(effects(i, j)) <= tiny || scale[j] != 0.0) continue;
        if (!(effects(i, j) * effects(j, i) > 0.0)) return false;
        scale[j] = scale[i] * effects(i, j) / effects(j, i);
        open.push_back(j);
      }
    }
  }
  const Matrix scaled = linalg::scaled_rows(scale, effects);
  return (scaled - scaled.transpose()).max_abs() <= 1e-9 * scaled.max_abs();
}

/// Two solutions differ by d with d^T D W d >= 0; where D W is symmetric and <= 0 that is W d = 0. Functions whose own
/// selections move nothing follow from the others.
bool velocity_is_unique(const Matrix& all) {
  std::vector<Index> acting;
  for (Index i = 0; i < all.cols(); ++i) {
    if (all.col(i).max_abs() > 0.0) acting.push_back(i);
  }
  if (acting.empty()) return true;
  const Matrix effects = all.selected(acting, acting);
  Vector scale;
  if (!symmetrise(effects, scale)) return false;
  const Matrix scaled = linalg::scaled_rows(scale, effects);
  return linalg::symmetric_eigenvalues(0.5 * (scaled + scaled.transpose())).max() <= 1e-9 * scaled.norm();
}

}  // namespace

Complementarity solve_complementarity(const Matrix& effects, const Vector& constant, double tolerance) {
  Complementarity found;
  // Each surface in units of its own.
  const Vector sizes = (constant.abs() + effects.abs().row_sums()).at_least(1e-300).inverses();
  found.lambda = lambda_in_boxes(linalg::scaled_rows(sizes, effects), sizes.times_each(constant));
  const Vector y = constant + effects * found.lambda;
  for (Index i = 0; i < y.size(); ++i) {
    const double terms = std::abs(constant[i]) + effects.row(i).sum_abs();
    const bool moves = std::abs(y[i]) > tolerance * terms;
    found.mode.push_back(!moves ? 0 : y[i] > 0.0 ? 1 : -1);
  }
  found.unique_velocity = velocity_is_unique(effects);
  return found;
}

}  // namespace saltus::switching
