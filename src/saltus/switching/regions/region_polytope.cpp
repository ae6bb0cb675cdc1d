#include "saltus/switching/regions/region_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/LU>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::switching {
namespace {

/// Of coordinates that come from gradients, relative to their size: far above rounding, far below what a model means.
constexpr double flat = 1e-9;

constexpr int most_regions = 12;
/// At most that many rows and columns: without allocation.
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_regions, most_regions>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_regions, 1>;

/// The normal of the hyperplane through m of the points, of length one; empty if these span less.
SmallVector normal_through(const Eigen::MatrixXd& points, const std::vector<int>& through) {
  const auto m = points.cols();
  if (m == 1) return SmallVector::Ones(1);
  Small edges(m - 1, m);
  for (Eigen::Index k = 1; k < m; ++k) {
    edges.row(k - 1) = points.row(through[at(k)]) - points.row(through[0]);
    const double length = edges.row(k - 1).norm();
    if (length == 0.0) return {};
    edges.row(k - 1) /= length;
  }
  Eigen::FullPivLU<Small> factors(edges);
  factors.setThreshold(flat);
  if (factors.rank() < m - 1) return {};
  return factors.kernel().col(0).normalized();
}

SmallVector distances(const Eigen::MatrixXd& points, const std::vector<int>& through, const SmallVector& normal) {
  SmallVector distance(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    distance[i] = (points.row(i) - points.row(through[0])).dot(normal);
  }
  return distance;
}

}  // namespace

std::optional<RegionPolytope> RegionPolytope::make(Eigen::MatrixXd points) {
  SALTUS_ASSERT(1 <= points.rows() && points.rows() <= most_regions);
  RegionPolytope polytope(std::move(points));
  if (!polytope.find_facets()) return std::nullopt;
  return polytope;
}

bool RegionPolytope::find_facets() {
  const int n = regions();
  const int m = dimension();
  if (m == 0) {
    heights_.resize(0, n);
    return true;
  }
  if (n <= m) return false;
  const Eigen::MatrixXd centred = points_.rowwise() - points_.colwise().mean();
  const double size = centred.cwiseAbs().maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size)) return false;
  std::vector<bool> chosen(static_cast<std::size_t>(n), false);
  std::fill_n(chosen.begin(), m, true);
  do {
    std::vector<int> through;
    for (int i = 0; i < n; ++i) {
      if (chosen[at(i)]) through.push_back(i);
    }
    const SmallVector normal = normal_through(points_, through);
    if (normal.size() == 0) continue;
    const SmallVector distance = distances(points_, through, normal);
    if (distance.minCoeff() < -flat * size && distance.maxCoeff() > flat * size) continue;
    RegionBits on = 0;
    for (int i = 0; i < n; ++i) on |= std::abs(distance[i]) <= flat * size ? RegionBits{1} << i : 0U;
    if (on == (RegionBits{1} << n) - 1) return false;  // all in one plane
    if (contains(facets_, on)) continue;
    facets_.push_back(on);
    spanning_.push_back(std::move(through));
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  heights_.resize(static_cast<Eigen::Index>(facets_.size()), n);
  normals_.resize(heights_.rows(), m);
  for (std::size_t f = 0; f < facets_.size(); ++f) set_facet(f);
  return facets_.size() > static_cast<std::size_t>(m);
}

void RegionPolytope::set_facet(std::size_t facet) {
  SmallVector normal = normal_through(points_, spanning_[facet]);
  if (normal.size() == 0) return;  // as it was: behind a move that turns it too far
  const auto row = static_cast<Eigen::Index>(facet);
  SmallVector height = distances(points_, spanning_[facet], normal);
  if (height.sum() < 0.0) {
    height = -height;
    normal = -normal;
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < height.size(); ++i) {
    const bool on = (facets_[facet] >> static_cast<unsigned>(i) & 1U) != 0;
    if (on) height[i] = 0.0;
    if (!on) smallest = std::min(smallest, std::abs(height[i]));
  }
  // Powers of whole numbers stay such: they can be continued through 0.
  for (double& h : height) {
    h = std::abs(h) / smallest;
    if (std::abs(h - std::round(h)) <= flat * h) h = std::round(h);
  }
  heights_.row(row) = height.transpose();
  normals_.row(row) = normal.transpose() / smallest;
}

void RegionPolytope::move(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  points_ = points;
  for (std::size_t f = 0; f < facets_.size(); ++f) set_facet(f);
}

std::vector<RegionBits> RegionPolytope::faces() const {
  const RegionBits all = (RegionBits{1} << regions()) - 1;
  std::set<RegionBits> known{all};
  std::vector<RegionBits> open{all};
  std::vector<RegionBits> found{all};
  while (!open.empty()) {
    const RegionBits face = open.back();
    open.pop_back();
    for (const RegionBits facet : facets_) {
      const RegionBits smaller = face & facet;
      if (smaller == 0 || !known.insert(smaller).second) continue;
      open.push_back(smaller);
      found.push_back(smaller);
    }
  }
  return found;
}

}  // namespace saltus::switching
