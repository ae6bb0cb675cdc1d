// Weights of regions whose indicators depend on each other: the equations and the products, on polytopes of all sorts.
#include "saltus/switching/regions/region_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/linalg/factors.hpp"
#include "saltus/switching/regions/tied_regions.hpp"

namespace saltus::switching {
namespace {

using linalg::Matrix;
using linalg::Vector;

struct Shape {
  std::string name;
  Matrix points;
  std::size_t facets, faces;
};

Matrix regular(int n) {
  Matrix points(n, 2);
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi / n * i + 0.3;
    points.row(i) = {std::cos(angle), std::sin(angle)};
  }
  return points;
}

std::vector<Shape> shapes() {
  const Matrix square{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, trapezium{{0, 0}, {2, 0}, {0, 1}, {1, 1}};
  const Matrix strip{{0}, {1}, {2.5}};
  const Matrix octahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const Matrix centred{{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};  // a region that is nowhere but at the point
  Matrix cube(8, 3);
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) cube(i, k) = i >> k & 1;
  }
  // Faces: all of the hull, with itself and without the empty one.
  return {{"square", square, 4, 9},       {"trapezium", trapezium, 4, 9}, {"pentagon", regular(5), 5, 11},
          {"strip", strip, 2, 3},         {"cube", cube, 6, 27},          {"octahedron", octahedron, 8, 27},
          {"hexagon", regular(6), 6, 13}, {"centred", centred, 4, 9}};
}

/// Rates of which the weights exp(y_i . v) are a root, inside.
Matrix rates_with_root(const Matrix& points, const Vector& theta, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Matrix rates(points.cols(), points.rows());
  for (double& rate : rates) rate = unit(random);
  return linalg::plus_column(rates, -(rates * theta));
}

Vector weights_at(const Matrix& points, const Vector& v) {
  Vector weights = points * v;
  const double largest = weights.max();
  for (double& weight : weights) weight = std::exp(weight - largest);
  return weights / weights.sum();
}

TEST(RegionPolytope, HasTheFacesOfItsHull) {
  for (const auto& shape : shapes()) {
    const auto polytope = RegionPolytope::make(shape.points);
    ASSERT_TRUE(polytope.has_value()) << shape.name;
    EXPECT_EQ(polytope->facets().size(), shape.facets) << shape.name;
    EXPECT_EQ(polytope->faces().size(), shape.faces) << shape.name;
    for (std::size_t f = 0; f < shape.facets; ++f) {
      // Heights are those along the normal, 0 on the facet and at least 1 elsewhere.
      const auto row = static_cast<linalg::Index>(f);
      const Vector along = shape.points * polytope->normals().row(row).transpose();
      for (linalg::Index i = 0; i < along.size(); ++i) {
        const double height = polytope->heights()(row, i);
        EXPECT_NEAR(along[i] - along.min(), height, 1e-12) << shape.name;
        EXPECT_EQ(height == 0.0, (polytope->facets()[f] >> i & 1U) != 0) << shape.name;
        EXPECT_TRUE(height == 0.0 || height >= 1.0 - 1e-12) << shape.name << height;
      }
    }
  }
  EXPECT_FALSE(RegionPolytope::make(Matrix::constant(4, 2, 1.0)).has_value());
}

TEST(RegionWeights, FindTheRootNearTheStartWithEveryProduct) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const auto& shape : shapes()) {
    RegionWeights weights(*RegionPolytope::make(shape.points));
    for (int trial = 0; trial < 200; ++trial) {
      Vector v(shape.points.cols()), away(shape.points.cols());
      for (double& value : v) value = 3.0 * unit(random);
      for (double& value : away) value = 1e-4 * unit(random);
      const Vector root = weights_at(shape.points, v);
      const Matrix rates = rates_with_root(shape.points, root, random);
      // A double root, or one whose twin is near by, leaves fewer digits: not what is asked here.
      const Matrix dynamics = weight_dynamics(shape.points, rates, root);
      const double determinant = linalg::determinant(dynamics);
      if (std::abs(determinant) < 1e-3 * std::pow(dynamics.norm(), static_cast<double>(v.size()))) continue;
      Vector theta = weights_at(shape.points, v + away);
      ASSERT_TRUE(weights.solve(rates, theta.data())) << shape.name << " " << trial;
      EXPECT_LT((theta - root).max_abs(), 1e-10) << shape.name << " " << trial;
      const double sign = determinant > 0.0 ? 1.0 : -1.0;
      EXPECT_GT(sign * weights.determinant(), 0.0) << shape.name << " " << trial;
      for (std::size_t f = 0; f < shape.facets; ++f) EXPECT_GT(weights.excess(f), 0.0);
    }
  }
}

TEST(RegionWeights, GoOnSmoothlyBehindAnExit) {
  // The square with a wind that drives the root through an edge: weights are those of alpha_1 = 1/2 - s/2, alpha_2 =
  // 1/2, of their own sign behind it.
  const Matrix points{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  RegionWeights weights(*RegionPolytope::make(points));
  for (const double s : {0.9, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.01, 1.1}) {
    const Matrix rates{{1 - s, -1 - s, 1 - s, -1 - s}, {1, 1, -1, -1}};
    Vector theta{0.475, 0.025, 0.475, 0.025};  // as of s = 0.9
    ASSERT_TRUE(weights.solve(rates, theta.data())) << s;
    EXPECT_NEAR(theta[1], 0.25 * (1.0 - s), 1e-15) << s;
    EXPECT_NEAR(theta[0], 0.25 * (1.0 + s), 1e-15) << s;
    const auto least = std::min({weights.excess(0), weights.excess(1), weights.excess(2), weights.excess(3)});
    EXPECT_NEAR(least, 0.5 * (1.0 - s), 1e-15) << s;
  }
}

TEST(TiedRegions, SetsAreThoseOfStewartsSystemWhereNothingDepends) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    const int m = 1 + trial % 3;
    Matrix points = Matrix::zero(m + 1, m);
    points.bottom_rows(m) = Matrix::identity(m, m);
    Matrix velocities(m, m + 1);
    for (double& value : velocities) value = unit(random);
    RegionRates rates{m + 1, std::vector<double>(static_cast<std::size_t>((m + 1) * (m + 1)), 0.0)};
    for (int i = 1; i <= m; ++i) {
      for (int j = 0; j <= m; ++j) rates.rates[static_cast<std::size_t>(i * (m + 1) + j)] = -velocities(i - 1, j);
    }
    const auto expected = admissible_region_sets(rates, 0.0);
    const auto sets = admissible_region_faces({*RegionPolytope::make(points), velocities}, 0.0);
    ASSERT_EQ(sets.size(), expected.size()) << trial;
    for (const auto& set : expected) {
      const auto same = std::find_if(sets.begin(), sets.end(), [&](const auto& s) { return s.active == set.active; });
      ASSERT_NE(same, sets.end()) << trial;
      EXPECT_EQ(same->attracts, set.attracts) << trial;
      for (std::size_t k = 0; k < set.weights.size(); ++k)
        EXPECT_NEAR(same->weights[k], set.weights[k], 1e-10) << trial;
    }
  }
}

// Quadrants of the plane, whose fields point inwards; with 4 added to one component they all point to one side.
TEST(TiedRegions, AreHeldBySomeWeightsWhereTheirFieldsSurroundZero) {
  const Matrix points{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  Matrix rates{{-1, 2, 1, -3}, {-1, -1, 2, 1}};
  EXPECT_TRUE(can_be_held({*RegionPolytope::make(points), rates}));
  rates.row(0).add_to_all(4.0);
  EXPECT_FALSE(can_be_held({*RegionPolytope::make(points), rates}));
}

TEST(TiedRegions, MotionsThatHangOnTheWeightsAreFound) {
  const Matrix points{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  const Matrix velocities{{1, -1, 1, -1}, {1, 1, -1, -1}};
  const RegionTie tie{*RegionPolytope::make(points), velocities};
  const auto sets = admissible_region_faces(tie, 0.0);
  ASSERT_EQ(sets.size(), 1U);
  Matrix fields(3, 4);
  fields.top_rows(2) = velocities;
  fields.row(2) = {0, 1, 2, 3};  // follows from the others
  EXPECT_FALSE(motion_depends_on_weights(tie, sets[0], fields));
  fields.row(2) = {0, 1, 2, 4};
  EXPECT_TRUE(motion_depends_on_weights(tie, sets[0], fields));
}

}  // namespace
}  // namespace saltus::switching
