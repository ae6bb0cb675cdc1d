// Problems of complementarity at a point: known answers, friction, dependent rows, several solutions, many blocks.
#include "saltus/switching/point/point_solver.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/base/at.hpp"
#include "saltus/switching/point/faces_by_pivots.hpp"
#include "saltus/switching/point/held_rows.hpp"
#include "saltus/switching/point/nonnegative_solution.hpp"
#include "saltus/switching/point/on_faces.hpp"
#include "saltus/switching/point/open_unknowns_internal.hpp"
#include "saltus/switching/point/pivoting.hpp"
#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching::testing {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

Block half_line(int row) { return {.kind = Block::Kind::half_line, .row = row}; }
Block box(int row, double lower, double upper) {
  return {.kind = Block::Kind::box, .row = row, .lower = lower, .upper = upper};
}
/// Normal rows first, then the tangential ones.
Block cone(int row, int tangent, double friction, double velocity = 0.0) {
  return {.kind = Block::Kind::friction,
          .row = row,
          .tangents = {tangent, -1},
          .friction = friction,
          .velocity = {velocity, 0.0}};
}

PointSolutions solve(const std::vector<Block>& blocks, const Matrix& effects, const Vector& constant) {
  return solve_point({blocks, effects, constant, constant.abs().max()}, {});
}

/// Whether z and y are what the blocks ask for, whatever the faces say: y, and tangential parts by their signs.
void expect_solution(const std::vector<Block>& blocks, const Matrix& effects, const Vector& constant,
                     const PointSolution& solution) {
  const Vector y = constant + effects * solution.z;
  const double force = 1e-6 * (1.0 + solution.z.max_abs()), speed = 1e-6 * (1.0 + y.max_abs());
  for (const Block& block : blocks) {
    const double z = solution.z(block.row), own = y(block.row);
    if (block.kind == Block::Kind::box) {
      EXPECT_GE(z, block.lower - force);
      EXPECT_LE(z, block.upper + force);
      if (own > speed) {
        EXPECT_NEAR(z, block.lower, force);
      }
      if (own < -speed) {
        EXPECT_NEAR(z, block.upper, force);
      }
      continue;
    }
    EXPECT_GE(z, -force);
    EXPECT_GE(own, -speed);
    EXPECT_NEAR(std::min(z, own), 0.0, std::max(force, speed));
    if (block.kind != Block::Kind::friction) continue;
    const double friction = solution.z(block.tangents[0]), limit = block.friction * z;
    const double slip = block.velocity[0] != 0.0 ? block.velocity[0] : y(block.tangents[0]);
    EXPECT_LE(std::abs(friction), limit + force);
    if (slip > speed) {
      EXPECT_NEAR(friction, -limit, force);
    }
    if (slip < -speed) {
      EXPECT_NEAR(friction, limit, force);
    }
  }
}

TEST(PointSolver, HalfLinesWithOneSolution) {
  const Matrix effects{{2.0, 1.0}, {1.0, 2.0}};
  const auto pressed = solve({half_line(0), half_line(1)}, effects, {-3.0, -3.0});
  ASSERT_EQ(pressed.all.size(), 1U);
  EXPECT_TRUE(pressed.complete);
  EXPECT_NEAR(pressed.all[0].z(0), 1.0, 1e-14);
  EXPECT_NEAR(pressed.all[0].z(1), 1.0, 1e-14);
  // The first one alone: y_2 = 1/2.
  const auto first = solve({half_line(0), half_line(1)}, effects, {-3.0, -1.0});
  ASSERT_EQ(first.all.size(), 1U);
  EXPECT_EQ(first.all[0].faces, (std::vector{Face::closed, Face::open}));
  EXPECT_NEAR(first.all[0].z(0), 1.5, 1e-14);
  EXPECT_NEAR(first.all[0].y(1), 0.5, 1e-14);
}

TEST(PointSolver, ABoxIsLeftOnBothSides) {
  const Matrix effects{{1.0}};
  const std::vector<std::pair<double, Face>> cases{{1.0, Face::lower}, {-0.4, Face::inside}, {-2.0, Face::upper}};
  for (const auto& [constant, face] : cases) {
    const auto found = solve({box(0, 0.0, 1.0)}, effects, {constant});
    ASSERT_EQ(found.all.size(), 1U);
    EXPECT_EQ(found.all[0].faces[0], face);
    EXPECT_NEAR(found.all[0].z(0), std::clamp(-constant, 0.0, 1.0), 1e-14);
  }
}

/// 0 <= z, complementary to w - z >= 0: with w = 1 both z = 0 and z = 1 do, with w = -1 nothing does.
TEST(PointSolver, SeveralSolutionsAndNone) {
  const Matrix effects{{-1.0}};
  const auto two = solve({half_line(0)}, effects, {1.0});
  ASSERT_EQ(two.all.size(), 2U);
  EXPECT_EQ(is_one_motion({{half_line(0)}, effects, Vector{1.0}, 1.0}, two, 0), false);
  EXPECT_TRUE(solve({half_line(0)}, effects, {-1.0}).all.empty());
}

/// A body on the ground that is pushed along it: it sticks up to friction times weight, and is slowed down by it.
TEST(PointSolver, FrictionOfOneContact) {
  const Matrix effects{{1.0, 0.0}, {0.0, 1.0}};
  const auto sticks = solve({cone(0, 1, 0.5)}, effects, {-10.0, 4.0});
  ASSERT_EQ(sticks.all.size(), 1U);
  EXPECT_EQ(sticks.all[0].faces[0], Face::stick);
  EXPECT_NEAR(sticks.all[0].margin, 0.1, 1e-14);
  const auto slides = solve({cone(0, 1, 0.5)}, effects, {-10.0, 6.0});
  ASSERT_EQ(slides.all.size(), 1U);
  EXPECT_EQ(slides.all[0].faces[0], Face::slip_up);
  EXPECT_NEAR(slides.all[0].y(1), 1.0, 1e-14);
  const auto slowed = solve({cone(0, 1, 0.5, -1.0)}, effects, {-10.0, 0.0});
  ASSERT_EQ(slowed.all.size(), 1U);
  EXPECT_NEAR(slowed.all[0].y(1), 5.0, 1e-14);
}

/// The paradox of Painleve: slip presses the contact on, n'M^-1(n - mu t) < 0.
TEST(PointSolver, AParadoxHasNoSolution) {
  const Matrix effects{{1.0, 0.8}, {0.8, 2.0}};
  const std::vector blocks{cone(0, 1, 2.0, 1.0)};
  EXPECT_TRUE(solve(blocks, effects, {-10.0, 0.0}).all.empty());
  EXPECT_EQ(solve(blocks, effects, {10.0, 0.0}).all.size(), 2U);
}

/// Two normals and two tangents in x, z and R phi: the ground carries the disc, and any squeeze from the wall would do.
TEST(PointSolver, ADiscInACornerIsAtRest) {
  const Matrix rows{{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 1.0}, {0.0, 1.0, -1.0}};
  const Matrix effects = rows * rows.transpose();
  const Vector constant{-10.0, 0.0, 0.0, -10.0};
  const std::vector blocks{cone(0, 2, 0.43), cone(1, 3, 1.51)};
  const auto found = solve(blocks, effects, constant);
  ASSERT_FALSE(found.all.empty());
  for (const auto& one : found.all) {
    expect_solution(blocks, effects, constant, one);
    EXPECT_LE(one.y.max_abs(), 1e-12);
  }
  const auto is_alone = [](const PointSolution& one) { return one.faces == std::vector{Face::stick, Face::open}; };
  const auto alone = std::find_if(found.all.begin(), found.all.end(), is_alone);
  ASSERT_NE(alone, found.all.end());
  EXPECT_NEAR(alone->z(0), 10.0, 1e-12);
  EXPECT_GT(margin_of_forces({blocks, effects, constant, 10.0}, *alone), 0.1);
  PointSolution squeezed;
  ASSERT_TRUE(solve_on({blocks, effects, constant, 10.0}, {Face::stick, Face::stick}, squeezed));
  EXPECT_TRUE(squeezed.is_open);
  EXPECT_TRUE(squeezed.is_stressed);
  EXPECT_GT(squeezed.margin, 1e-2);
  EXPECT_EQ(is_one_motion({blocks, effects, constant, 10.0}, found, 0), true);
}

/// Of four places below a brick two carry it, in the middle between them, without friction.
TEST(PointSolver, ABrickOnFourPlaces) {
  Matrix rows = Matrix::zero(8, 3);
  for (Index i = 0; i < 4; ++i) {
    rows(i, 1) = rows(4 + i, 0) = 1.0;
    rows(i, 2) = -0.75 + 0.5 * static_cast<double>(i);
    rows(4 + i, 2) = 0.25;
  }
  const Matrix effects = rows * rows.transpose();
  const Vector constant{-10.0, -10.0, -10.0, -10.0, 0.0, 0.0, 0.0, 0.0};
  const std::vector blocks{cone(0, 4, 0.5), cone(1, 5, 0.5), cone(2, 6, 0.5), cone(3, 7, 0.5)};
  PointSolution found;
  ASSERT_TRUE(solve_on({blocks, effects, constant, 10.0}, std::vector(4, Face::stick), found));
  expect_solution(blocks, effects, constant, found);
  EXPECT_EQ(found.idle.size(), 2U);
  EXPECT_GT(found.margin, 0.1);
}

/// A block between two rough walls falls, or is held by any pressure.
TEST(PointSolver, ABlockInAViseHasTwoMotions) {
  const Matrix rows{{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, 1.0}};
  const Matrix effects = rows * rows.transpose();
  const Vector constant{0.0, 0.0, -10.0, -10.0};
  const std::vector blocks{cone(0, 2, 0.5), cone(1, 3, 0.5)};
  const auto found = solve(blocks, effects, constant);
  for (const auto& one : found.all) expect_solution(blocks, effects, constant, one);
  EXPECT_EQ(is_one_motion({blocks, effects, constant, 10.0}, found, 0), false);
}

/// Contacts at random places of a chain of bodies, some of them slipping.
struct Pile {
  std::vector<Block> blocks;
  Matrix effects;
  Vector constant;
};

Pile pile(std::mt19937& random, int contacts, int positions, double slipping) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Matrix rows = Matrix::zero(2 * contacts, positions);
  for (int i = 0; i < contacts; ++i) {
    const int first = (i * 3) % positions;
    for (int k = first; k < std::min(positions, first + 5); ++k) {
      rows(i, k) = number(random);
      rows(contacts + i, k) = number(random);
    }
  }
  Pile result{{}, rows * rows.transpose(), {}};
  Vector force(positions);
  for (Index k = 0; k < positions; ++k) force(k) = number(random);
  result.constant = rows * force;
  for (int i = 0; i < contacts; ++i) {
    const double velocity = number(random) < 2.0 * slipping - 1.0 ? number(random) : 0.0;
    result.blocks.push_back(cone(i, contacts + i, 0.5 * std::abs(number(random)) + 0.05, velocity));
  }
  return result;
}

TEST(PointSolver, WhatIsFoundIsASolutionAndPivotsFindOneWhereThereIsOne) {
  std::mt19937 random(7);
  int solvable = 0, by_pivots = 0;
  for (int instance = 0; instance < 300; ++instance) {
    const int contacts = 1 + instance % 4;
    const auto [blocks, effects, constant] = pile(random, contacts, 3 + instance % 6, 0.3);
    const std::vector<std::vector<Face>> none(blocks.size());
    const PointProblem problem{blocks, effects, constant, constant.max_abs()};
    const auto found = solve_point(problem, {none, {}});
    for (const auto& one : found.all) expect_solution(blocks, effects, constant, one);
    if (found.all.empty()) continue;
    ++solvable;
    std::vector<std::vector<Face>> options;
    for (const Block& block : blocks) {
      options.push_back({Face::stick, Face::slip_up, Face::slip_down, Face::open});
      if (block.velocity[0] != 0.0)
        options.back() = {block.velocity[0] > 0.0 ? Face::slip_up : Face::slip_down, Face::open};
    }
    PointSolution solution;
    const auto vertex = vertex_by_pivots(problem, options);
    if (!vertex || !solve_on(problem, vertex->faces, solution) || solution.margin < face_holds) continue;
    ++by_pivots;
    expect_solution(blocks, effects, constant, solution);
  }
  EXPECT_GT(solvable, 250);
  EXPECT_EQ(by_pivots, solvable);
}

TEST(PointSolver, SixtyContactsWithFriction) {
  std::mt19937 random(11);
  for (int instance = 0; instance < 5; ++instance) {
    const auto [blocks, effects, constant] =
        pile(random, 60, instance % 2 == 0 ? 130 : 60, instance % 2 == 0 ? 0.2 : 0.0);
    const auto found = solve(blocks, effects, constant);
    ASSERT_FALSE(found.all.empty()) << instance;
    EXPECT_FALSE(found.complete);
    for (const auto& one : found.all) expect_solution(blocks, effects, constant, one);
  }
}

/// Discs of mass 1 in rows of `base`, base - 1, ... discs on the ground, each on two of the row below: all that bodies
/// alike have in common, and more rows than velocities.
struct Pyramid {
  std::vector<Block> blocks;
  Matrix effects;
  Vector constant;
};
Pyramid pyramid(int base, double friction) {
  const double radius = 0.1, height = std::sqrt(0.75);
  const int contacts = base * base;
  Matrix directions = Matrix::zero(2 * contacts, 3 * base * (base + 1) / 2);
  Pyramid result;
  const auto add = [&](int upper, int lower, double along, double up) {
    const auto row = static_cast<int>(result.blocks.size());
    for (const auto& [disc, sign] : {std::pair(upper, 1.0), std::pair(lower, -1.0)}) {
      if (disc < 0) continue;
      directions(row, 3 * disc) = sign * along;
      directions(row, 3 * disc + 1) = sign * up;
      directions(contacts + row, 3 * disc) = sign * up;
      directions(contacts + row, 3 * disc + 1) = -sign * along;
      directions(contacts + row, 3 * disc + 2) = radius;
    }
    result.blocks.push_back(cone(row, contacts + row, friction));
  };
  for (int level = 0, first = 0; level < base; first += base - level, ++level) {
    for (int disc = first; disc < first + base - level; ++disc) {
      if (level == 0) add(disc, -1, 0.0, 1.0);
      if (level > 0) add(disc, disc - (base - level) - 1, 0.5, height);
      if (level > 0) add(disc, disc - (base - level), -0.5, height);
    }
  }
  Vector responses(directions.cols()), weights = Vector::zero(directions.cols());
  for (Index k = 0; k < responses.size(); ++k) {
    responses(k) = k % 3 == 2 ? 2.0 / (radius * radius) : 1.0;
    if (k % 3 == 1) weights(k) = -9.81;
  }
  result.effects = linalg::scaled_cols(directions, responses) * directions.transpose();
  result.constant = directions * weights;
  return result;
}

TEST(PointSolver, PyramidsOfDiscs) {
  for (const int base : {3, 5, 6, 7, 8}) {
    for (const double friction : {0.3, 0.6, 1.0}) {
      const auto [blocks, effects, constant] = pyramid(base, friction);
      const auto found = solve(blocks, effects, constant);
      ASSERT_FALSE(found.all.empty()) << base << " " << friction;
      expect_solution(blocks, effects, constant, found.all.front());
    }
  }
}

TEST(HeldRows, TakeTheLeastOfWhatDependentRowsLeaveOpen) {
  HeldRows rows(2);
  for (const int row : {0, 1}) rows.hold(row);
  Vector z;
  EXPECT_EQ(rows.solve({{1.0, 1.0}, {1.0, 1.0}}, {-2.0, -2.0}, z), HeldRows::Solution::open);
  EXPECT_NEAR(z(0), 1.0, 1e-14);
  EXPECT_NEAR(z(1), 1.0, 1e-14);
  EXPECT_EQ(rows.open({{1.0, 1.0}, {1.0, 1.0}}).cols(), 1);
  EXPECT_EQ(rows.solve({{1.0, 1.0}, {1.0, 1.0}}, {-2.0, 2.0}, z), HeldRows::Solution::none);
}

TEST(ComplementaryPivots, AgreeWithKnownAnswers) {
  const auto z = complementary_pivots({{2.0, 1.0}, {1.0, 2.0}}, {-5.0, -6.0});
  ASSERT_TRUE(z.has_value());
  EXPECT_NEAR((*z)[0], 4.0 / 3.0, 1e-12);
  EXPECT_NEAR((*z)[1], 7.0 / 3.0, 1e-12);
  EXPECT_FALSE(complementary_pivots({{-1.0}}, {-1.0}).has_value());
  // Equal rows: any split of the force does.
  const auto shared = complementary_pivots({{1.0, 1.0}, {1.0, 1.0}}, {-2.0, -2.0});
  ASSERT_TRUE(shared.has_value());
  EXPECT_NEAR((*shared)[0] + (*shared)[1], 2.0, 1e-12);
}

TEST(NonnegativeSolution, HasTheLeastResidual) {
  const Matrix A{{1.0, -2.0, 0.5, 3.0}, {0.0, 1.0, 1.0, -1.0}, {1.0, 1.0, 1.0, 1.0}};
  for (const Vector& b :
       {Vector{0.0, 0.0, 1.0}, Vector{0.0, -5.0, 1.0}, Vector{-1.0, -1.0, -1.0}, Vector{2.0, 0.3, 1.0}}) {
    const Vector x = nonnegative_solution(A, b);
    const Vector slope = A.transpose() * (b - A * x);
    for (Index j = 0; j < x.size(); ++j) {
      EXPECT_GE(x[j], 0.0);
      EXPECT_LE(slope[j], 1e-9);
      EXPECT_NEAR(x[j] * slope[j], 0.0, 1e-9);
    }
  }
}

TEST(NonnegativeSolution, TakesIndependentColumns) {
  // Of equal columns one, and the shorter ones of those that do as well.
  const Matrix A{{-1.0, -1.0, 4.0, 8.0, 4.0}, {1.0, 1.0, 1.0, 1.0, 1.0}};
  const Vector x = nonnegative_solution(A, Vector{0.0, 1.0});
  EXPECT_NEAR(x[0], 0.8, 1e-14);
  EXPECT_NEAR(x[2], 0.2, 1e-14);
  EXPECT_EQ(std::ranges::count_if(x, [](double weight) { return weight > 0.0; }), 2);
}

}  // namespace
}  // namespace saltus::switching::testing
