#include "saltus/switching/regions/tied_regions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/point/nonnegative_solution.hpp"
#include "saltus/switching/regions/region_weights.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

using linalg::Matrix;
using linalg::Vector;

/// A face as a polytope of its own, in differences from its first region along a basis of them.
struct TiedFace {
  std::vector<int> active;
  RegionPolytope polytope;
  Matrix rates;  ///< of the coordinates along the basis, for the regions of the face
};

/// Part of a difference that the ones before do not span, relative to it, below which it depends on them.
constexpr double independent_difference = 1e-6;

std::optional<TiedFace> face_of(const RegionTie& tie, const std::vector<int>& active) {
  const Matrix& points = tie.polytope.points();
  const auto count = index(active.size());
  Matrix differences(count, points.cols());
  for (linalg::Index k = 0; k < count; ++k) {
    differences.row(k) = points.row(active[static_cast<std::size_t>(k)]) - points.row(active[0]);
  }
  // The largest remainder first, so that coordinates are of the order of one.
  Matrix rest = differences;
  std::vector<linalg::Index> basis;
  const double size = differences.row_norms().max();
  while (basis.size() < static_cast<std::size_t>(std::min(points.cols(), count - 1))) {
    const Vector left = rest.row_norms();
    const linalg::Index best = left.index_of_max();
    if (!(left[best] > independent_difference * size)) break;
    const Vector direction = rest.row(best).normalized();
    rest -= (rest * direction) * direction.transpose();
    basis.push_back(best);
  }
  std::sort(basis.begin(), basis.end());
  Matrix spanning(index(basis.size()), points.cols());
  for (std::size_t k = 0; k < basis.size(); ++k) spanning.row(index(k)) = differences.row(basis[k]);
  Matrix coordinates(count, index(basis.size()));
  if (!basis.empty()) {
    const linalg::Ldl products(spanning * spanning.transpose());
    coordinates = products.solve(spanning * differences.transpose()).transpose();
  }
  Matrix rates(index(basis.size()), count);
  for (linalg::Index k = 0; k < count; ++k) {
    rates.col(k) = spanning * tie.rates.col(active[static_cast<std::size_t>(k)]);
  }
  auto polytope = RegionPolytope::make(std::move(coordinates));
  if (!polytope) return std::nullopt;
  return TiedFace{active, std::move(*polytope), std::move(rates)};
}

/// The smallest of what is to be positive: weights off the facets of the face, and how fast the others fall behind.
double margin_of_tie(const RegionTie& tie, const RegionWeights& weights, const RegionSet& set) {
  double margin = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < weights.polytope().facets().size(); ++f) margin = std::min(margin, weights.excess(f));
  Vector velocity = Vector::zero(tie.rates.rows());
  for (std::size_t k = 0; k < set.active.size(); ++k) velocity += set.weights[k] * tie.rates.col(set.active[k]);
  const Vector ahead = tie.polytope.points() * velocity;
  const double scale = (tie.polytope.points() * tie.rates).max_abs();
  for (linalg::Index i = 0; i < ahead.size(); ++i) {
    if (std::binary_search(set.active.begin(), set.active.end(), static_cast<int>(i))) continue;
    margin = std::min(margin, (ahead[set.active[0]] - ahead[i]) / (scale > 0.0 ? scale : 1.0));
  }
  return margin;
}

bool solve_on(const RegionTie& tie, const TiedFace& face, RegionWeights& weights, const std::vector<double>& near,
              RegionSet& set) {
  set.active = face.active;
  set.weights = near;
  if (!weights.solve(face.rates, set.weights.data())) return false;
  set.margin = margin_of_tie(tie, weights, set);
  return !std::isnan(set.margin);
}

/// Whether the weights return to those of the set where they follow the indicators.
bool face_attracts(const TiedFace& face, const RegionSet& set) {
  const auto m = face.rates.rows();
  if (m == 0) return true;
  const linalg::ConstView theta(set.weights.data(), index(set.weights.size()));
  const Matrix dynamics = weight_dynamics(face.polytope.points(), face.rates, theta);
  std::vector<double> entries;
  for (linalg::Index row = 0; row < m; ++row) {
    for (linalg::Index column = 0; column < m; ++column) entries.push_back(dynamics(row, column));
  }
  return is_hurwitz(entries, static_cast<int>(m));
}

/// Weights to start from: the centre, and near each region and the side opposite of it.
std::vector<std::vector<double>> starts(const RegionPolytope& polytope) {
  const Matrix& points = polytope.points();
  const Matrix centred = linalg::plus_row(points, points.col_sums() / -static_cast<double>(points.rows()));
  const double radius = centred.row_norms().max(), size = radius * radius;
  std::vector<std::vector<double>> found;
  const auto add = [&](const Vector& exponents) {
    const double largest = exponents.max();
    auto& weights = found.emplace_back(exponents.begin(), exponents.end());
    for (double& weight : weights) weight = std::exp(weight - largest);
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= sum;
  };
  add(Vector::zero(centred.rows()));
  if (!(size > 0.0)) return found;
  for (linalg::Index i = 0; i < centred.rows(); ++i) {
    const Vector towards = 2.0 / size * (centred * centred.row(i).transpose());
    add(towards);
    add(-towards);
  }
  return found;
}

bool is_known(const std::vector<RegionSet>& sets, const RegionSet& set) {
  return std::any_of(sets.begin(), sets.end(), [&](const RegionSet& other) {
    return other.active == set.active && std::equal(set.weights.begin(), set.weights.end(), other.weights.begin(),
                                                    [](double a, double b) { return std::abs(a - b) <= 1e-6; });
  });
}

std::vector<int> regions_of(RegionBits face) {
  std::vector<int> active;
  for (int i = 0; face >> i != 0; ++i) {
    if ((face >> i & 1U) != 0) active.push_back(i);
  }
  return active;
}

}  // namespace

bool solve_region_face(const RegionTie& tie, const std::vector<int>& active, const std::vector<double>& near,
                       RegionSet& set) {
  const auto face = face_of(tie, active);
  if (!face) return false;
  RegionWeights weights(face->polytope);
  return solve_on(tie, *face, weights, near, set);
}

std::vector<RegionSet> admissible_region_faces(const RegionTie& tie, double tolerance) {
  std::vector<RegionSet> found;
  for (const RegionBits bits : tie.polytope.faces()) {
    const auto face = face_of(tie, regions_of(bits));
    if (!face) continue;
    RegionWeights weights(face->polytope);
    for (const auto& start : starts(face->polytope)) {
      RegionSet set;
      if (!solve_on(tie, *face, weights, start, set) || !(set.margin >= -tolerance) || is_known(found, set)) continue;
      set.attracts = face_attracts(*face, set);
      found.push_back(std::move(set));
    }
  }
  return found;
}

bool can_be_held(const RegionTie& tie) {
  const auto m = tie.rates.rows();
  const auto n = tie.rates.cols();
  if (n <= m) return false;
  const double size = tie.rates.max_abs();
  Matrix equations(m + 1, n);
  equations.top_rows(m) = size > 0.0 ? Matrix(tie.rates / size) : tie.rates;
  equations.bottom_rows(1).set_constant(1.0);
  const Vector sum_is_one = Vector::unit(m + 1, m);
  constexpr double rounding = 1e-13;
  return (equations * nonnegative_solution(equations, sum_is_one) - sum_is_one).max_abs() <= rounding;
}

bool motion_depends_on_weights(const RegionTie& tie, const RegionSet& set, const Matrix& fields) {
  const auto face = face_of(tie, set.active);
  if (!face) return false;
  const auto count = index(set.active.size());
  Matrix equations(face->rates.rows() + 1, count);
  equations.top_rows(face->rates.rows()) = face->rates;
  equations.bottom_rows(1).set_constant(1.0);
  const double size = face->rates.max_abs();
  if (size > 0.0) equations.top_rows(face->rates.rows()) /= size;
  linalg::FullLu factors(equations);
  factors.set_threshold(1e-12);
  if (factors.dimension_of_kernel() == 0) return false;
  Matrix own(fields.rows(), count);
  for (linalg::Index k = 0; k < count; ++k) own.col(k) = fields.col(set.active[static_cast<std::size_t>(k)]);
  // Weights are between 0 and 1: what their changes move, against what the fields do, state by state.
  const Matrix kernel = factors.kernel();
  const Matrix motion = own * kernel;
  const double change = kernel.max_abs();
  for (linalg::Index row = 0; row < own.rows(); ++row) {
    if (motion.row(row).max_abs() > 1e-9 * change * own.row(row).max_abs()) return true;
  }
  return false;
}

}  // namespace saltus::switching
