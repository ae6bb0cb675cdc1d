#include "saltus/switching/regions/region_polytope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::switching {
namespace {

/// Of coordinates that come from gradients, relative to their size: far above rounding, far below what a model means.
constexpr double flat = 1e-9;

constexpr int most_regions = 12;

// Vectors have at most that many entries, which lie inside of them: without allocation.
using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// What m - 1 rows of length one take to 0, of length one; empty where they depend on each other. By elimination with
/// pivots from all entries: linalg::FullLu allocates.
Vector kernel_of(Matrix& rows) {
  const Index m = rows.cols();
  std::array<Index, most_regions> order;
  for (Index k = 0; k < m; ++k) order[at(k)] = k;
  double largest = 0.0;
  for (Index k = 0; k < m - 1; ++k) {
    Index row = k, column = k;
    for (Index j = k; j < m; ++j) {
      for (Index i = k; i < m - 1; ++i) {
        if (std::abs(rows(i, j)) > std::abs(rows(row, column))) row = i, column = j;
      }
    }
    const double pivot = std::abs(rows(row, column));
    largest = std::max(largest, pivot);
    if (!(pivot > flat * largest)) return {};
    for (Index j = 0; j < m; ++j) std::swap(rows(k, j), rows(row, j));
    for (Index i = 0; i < m - 1; ++i) std::swap(rows(i, k), rows(i, column));
    std::swap(order[at(k)], order[at(column)]);
    for (Index i = k + 1; i < m - 1; ++i) rows.row(i).add_scaled(-rows(i, k) / rows(k, k), rows.row(k));
  }
  Vector kernel(m);
  kernel[order[at(m - 1)]] = 1.0;
  for (Index k = m - 2; k >= 0; --k) {
    double sum = 0.0;
    for (Index j = k + 1; j < m; ++j) sum += rows(k, j) * kernel[order[at(j)]];
    kernel[order[at(k)]] = -sum / rows(k, k);
  }
  kernel /= kernel.norm();
  return kernel;
}

/// The normal of the hyperplane through m of the points, of length one; empty if these span less.
/// @param edges  work
Vector normal_through(const Matrix& points, const std::vector<int>& through, Matrix& edges) {
  const Index m = points.cols();
  if (m == 1) return Vector::ones(1);
  edges.resize(m - 1, m);
  for (Index k = 1; k < m; ++k) {
    edges.row(k - 1) = points.row(through[at(k)]) - points.row(through[0]);
    const double length = edges.row(k - 1).norm();
    if (length == 0.0) return {};
    edges.row(k - 1) /= length;
  }
  return kernel_of(edges);
}

Vector distances(const Matrix& points, const std::vector<int>& through, const Vector& normal) {
  Vector distance(points.rows());
  for (Index i = 0; i < points.rows(); ++i) {
    distance[i] = (points.row(i) - points.row(through[0])).dot(normal);
  }
  return distance;
}

}  // namespace

std::optional<RegionPolytope> RegionPolytope::make(Matrix points) {
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
  const Matrix centred = linalg::plus_row(points_, points_.col_sums() / -static_cast<double>(n));
  const double size = centred.max_abs();
  if (!(size > 0.0) || !std::isfinite(size)) return false;
  std::vector<bool> chosen(static_cast<std::size_t>(n), false);
  std::fill_n(chosen.begin(), m, true);
  do {
    std::vector<int> through;
    for (int i = 0; i < n; ++i) {
      if (chosen[at(i)]) through.push_back(i);
    }
    const Vector normal = normal_through(points_, through, edges_);
    if (normal.size() == 0) continue;
    const Vector distance = distances(points_, through, normal);
    if (distance.min() < -flat * size && distance.max() > flat * size) continue;
    RegionBits on = 0;
    for (int i = 0; i < n; ++i) on |= std::abs(distance[i]) <= flat * size ? RegionBits{1} << i : 0U;
    if (on == (RegionBits{1} << n) - 1) return false;  // all in one plane
    if (contains(facets_, on)) continue;
    facets_.push_back(on);
    spanning_.push_back(std::move(through));
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  heights_.resize(static_cast<Index>(facets_.size()), n);
  normals_.resize(heights_.rows(), m);
  for (std::size_t f = 0; f < facets_.size(); ++f) set_facet(f);
  return facets_.size() > static_cast<std::size_t>(m);
}

void RegionPolytope::set_facet(std::size_t facet) {
  Vector normal = normal_through(points_, spanning_[facet], edges_);
  if (normal.size() == 0) return;  // as it was: behind a move that turns it too far
  const auto row = static_cast<Index>(facet);
  Vector height = distances(points_, spanning_[facet], normal);
  if (height.sum() < 0.0) {
    height *= -1.0;
    normal *= -1.0;
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < height.size(); ++i) {
    const bool on = (facets_[facet] >> static_cast<unsigned>(i) & 1U) != 0;
    if (on) height[i] = 0.0;
    if (!on) smallest = std::min(smallest, std::abs(height[i]));
  }
  // Powers of whole numbers stay such: they can be continued through 0.
  for (double& h : height) {
    h = std::abs(h) / smallest;
    if (std::abs(h - std::round(h)) <= flat * h) h = std::round(h);
  }
  heights_.row(row) = height;
  normals_.row(row) = normal / smallest;
}

void RegionPolytope::move(linalg::ConstView points) {
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
