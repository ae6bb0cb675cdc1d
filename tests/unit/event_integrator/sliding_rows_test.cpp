// Rows of sliding surfaces: their normal equations, and exit functions that are kept.
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/sliding/exit_rows.hpp"
#include "saltus/event_integrator/sliding/normal_rows.hpp"
#include "saltus/event_integrator/sliding/surface_rows.hpp"
#include "saltus/linalg/factors.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

TEST(NormalRows, AreSolvedAsTheWholeMatrixIs) {
  // Rows 0, 2 and 4 share columns, rows 1 and 3 are alone.
  const std::vector<std::vector<double>> dense{{1.0, 2.0, 0.0, 0.0, 0.0, 0.0},
                                               {0.0, 0.0, 3.0, 0.0, 0.0, 0.0},
                                               {0.0, 1.0, 0.0, -1.0, 0.0, 0.0},
                                               {0.0, 0.0, 0.0, 0.0, 0.5, -2.0},
                                               {4.0, 0.0, 0.0, 1.0, 0.0, 0.0}};
  NormalRows rows;
  rows.resize(5, 6);
  linalg::Matrix whole(5, 6);
  for (std::size_t i = 0; i < 5; ++i) {
    rows.set(i, dense[i]);
    for (std::size_t k = 0; k < 6; ++k)
      whole(static_cast<linalg::Index>(i), static_cast<linalg::Index>(k)) = dense[i][k];
  }
  EXPECT_EQ(rows[1].only(), 2);
  EXPECT_EQ(rows[3].only(), -1);
  EXPECT_EQ(rows[0].dot({1.0, 10.0, 0.0, 0.0, 0.0, 0.0}, 0.5), 21.5);
  linalg::Vector residual{1.0, -2.0, 3.0, 0.5, -1.0};
  const linalg::Vector expected = linalg::inverse(whole * whole.transpose()) * residual;
  ASSERT_TRUE(rows.solve(residual));
  for (linalg::Index i = 0; i < 5; ++i) EXPECT_NEAR(residual[i], expected[i], 1e-13);
  const linalg::Vector product = whole.transpose() * residual;
  for (int pass = 0; pass < 2; ++pass) {  // the second one finds nothing left of the first
    std::vector<double> x(6, 3.0);
    EXPECT_TRUE(rows.subtract_transposed(residual, x.data()));
    for (linalg::Index i = 0; i < 6; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i)], 3.0 - product[i], 1e-13);
    EXPECT_FALSE(rows.subtract_transposed(linalg::Vector::zero(5), x.data()));
  }
}

/// Rows of a chain share a column with the next one: many of them are solved by a sparse factorisation.
// x + y = 3 and y - 2 z = 1 are affine: one step is there, by the shortest way.
TEST(NormalRows, ACorrectionIsAStepOfNewton) {
  NormalRows rows;
  rows.resize(2, 3);
  rows.set(0, {1.0, 1.0, 0.0});
  rows.set(1, {0.0, 1.0, -2.0});
  std::vector<double> x{1.0, 1.0, 1.0};
  linalg::Vector residual = linalg::Vector::zero(2);
  residual[0] = x[0] + x[1] - 3.0;
  residual[1] = x[1] - 2.0 * x[2] - 1.0;
  EXPECT_TRUE(rows.correct(residual, x.data()));
  EXPECT_NEAR(x[0] + x[1], 3.0, 1e-15);
  EXPECT_NEAR(x[1] - 2.0 * x[2], 1.0, 1e-15);
  EXPECT_NEAR(2.0 * (x[0] - 1.0) - 2.0 * (x[1] - 1.0) - (x[2] - 1.0), 0.0, 1e-15);  // nothing along the line
  residual.set_zero();
  EXPECT_FALSE(rows.correct(residual, x.data()));
}

// The second pass has other columns in the same places of memory: rows that were alone share one.
TEST(IndependentRows, GradientsMayChangeBetweenSolutions) {
  NormalRows gradients;
  gradients.resize(3, 3);
  IndependentRows independent;
  independent.rows = {0, 2};
  for (const double shared : {0.0, 1.0}) {
    const std::vector<double> first{2.0, 0.0, shared}, last{0.0, shared, 1.0};
    gradients.set(0, first);
    gradients.set(1, first);
    gradients.set(2, last);
    linalg::Vector residual{1.0, 5.0, -3.0};
    ASSERT_TRUE(independent.solve(gradients, 3, residual));
    const linalg::Matrix rows{{first[0], first[1], first[2]}, {last[0], last[1], last[2]}};
    const linalg::Vector expected = linalg::inverse(rows * rows.transpose()) * linalg::Vector{1.0, -3.0};
    EXPECT_NEAR(residual[0], expected[0], 1e-14) << shared;
    EXPECT_EQ(residual[1], 0.0);
    EXPECT_NEAR(residual[2], expected[1], 1e-14) << shared;
  }
}

TEST(NormalRows, WithoutASolutionNothingIsCorrected) {
  NormalRows rows;
  rows.resize(2, 2);
  rows.set(0, {1.0, 1.0});
  rows.set(1, {2.0, 2.0});
  std::vector<double> x{1.0, 2.0};
  linalg::Vector residual = linalg::Vector::zero(2);
  residual[0] = 1.0;
  EXPECT_FALSE(rows.correct(residual, x.data()));
  EXPECT_EQ(x, (std::vector<double>{1.0, 2.0}));
}

TEST(NormalRows, ManyInAChainAreSolvedAsTheWholeMatrixIs) {
  constexpr std::size_t n = 40;
  const auto solve = [&](double coupling, linalg::Vector& residual) {
    NormalRows rows;
    rows.resize(n, n);
    linalg::Matrix whole;
    whole.set_zero(n, n);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> row(n, 0.0);
      row[i] = 1.0;
      if (i > 0) row[i - 1] = coupling;
      rows.set(i, row);
      for (std::size_t k = 0; k < n; ++k) whole(static_cast<linalg::Index>(i), static_cast<linalg::Index>(k)) = row[k];
    }
    const linalg::Vector expected = linalg::inverse(whole * whole.transpose()) * residual;
    EXPECT_TRUE(rows.solve(residual));
    for (linalg::Index i = 0; i < residual.size(); ++i) EXPECT_NEAR(residual[i], expected[i], 1e-10);
  };
  for (const double coupling : {-0.5, 0.3}) {
    linalg::Vector residual = linalg::Vector::ones(n);
    solve(coupling, residual);
  }
}

TEST(NormalRows, ManyThatDependHaveNoSolution) {
  constexpr std::size_t n = 40;  // a ring of differences: their sum is 0
  NormalRows rows;
  rows.resize(n, n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> row(n, 0.0);
    row[i] = 1.0;
    row[(i + 1) % n] = -1.0;
    rows.set(i, row);
  }
  linalg::Vector residual = linalg::Vector::ones(n);
  residual[3] = 2.0;
  EXPECT_FALSE(rows.solve(residual));
}

/// Of many surfaces one that is the sum of two others is found among them.
TEST(ProjectedFields, ManyGradientsDependWhereOneIsASumOfOthers) {
  for (const bool depends : {false, true}) {
    constexpr int n = 20;
    auto s = testing::blank(n, n);
    std::vector<SX> f;
    for (int i = 0; i < n; ++i) {
      const bool sum = depends && i == n - 1;
      testing::add_surface(s, "s" + std::to_string(i), sum ? s.x(3) + s.x(7) : s.x(i) - (i > 0 ? 0.5 * s.x(i - 1) : 0));
      f.push_back(1 - 2 * s.alpha(i));
    }
    testing::set_field(s, f, std::vector<double>(n, 0.0));
    const auto kernel = evaluation::ModelKernel::compile(s);
    ASSERT_TRUE(kernel.has_value());
    const std::vector<double> x(n, 0.0), alpha(n, 0.5);
    SwitchingPoint point;
    point.x = x.data();
    std::vector<int> all(n);
    for (int i = 0; i < n; ++i) all[static_cast<std::size_t>(i)] = i;
    EXPECT_EQ(ProjectedFields(*kernel, point).gradients_depend(alpha, all), depends);
  }
}

TEST(NormalRows, DependentAndEmptyOnesHaveNoSolution) {
  NormalRows rows;
  rows.resize(2, 2);
  rows.set(0, std::vector<double>{1.0, 2.0});
  rows.set(1, std::vector<double>{2.0, 4.0});
  linalg::Vector residual = linalg::Vector::ones(2);
  EXPECT_FALSE(rows.solve(residual));
  rows.set(1, std::vector<double>{0.0, 0.0});
  EXPECT_FALSE(rows.solve(residual));
}

/// The exit function of x0 depends on the selection of x1, linear in x1; that of x1 is linear in x0 alone.
model::System with_a_neighbour() {
  auto s = testing::blank(2, 2);
  testing::add_surface(s, "x0", s.x(0));
  testing::add_surface(s, "x1", s.x(1));
  const SX sign_0 = 2 * s.alpha(0) - 1, sign_1 = 2 * s.alpha(1) - 1;
  testing::set_field(s, {3 * s.x(1) - 2 * sign_0 + (5 + s.x(1)) * sign_1, 7 * s.x(0) - sign_1}, {0.0, 0.0});
  return s;
}

TEST(ExitRows, AreThoseOfTheSelectionsAskedFor) {
  const auto kernel = evaluation::ModelKernel::compile(with_a_neighbour());
  ASSERT_TRUE(kernel.has_value());
  ExitRows rows(*kernel);
  // More selections beside the surface than are kept; each comes back.
  for (int pass = 0; pass < 3; ++pass) {
    for (const auto how : {ExitRows::Rows::lasting, ExitRows::Rows::changing}) {
      for (const double beside : {0.0, 1.0, 0.25, 0.5, 0.75, 0.125}) {
        for (const double side : {0.0, 1.0}) {
          const auto* row = rows.of(0, side, {}, {0.5, beside}, how);
          ASSERT_NE(row, nullptr);
          EXPECT_EQ(row->column, (std::vector<std::size_t>{1}));
          EXPECT_DOUBLE_EQ(row->coefficient.front(), 3.0 + (2.0 * beside - 1.0));
          EXPECT_DOUBLE_EQ(row->offset, -2.0 * (2.0 * side - 1.0) + 5.0 * (2.0 * beside - 1.0));
        }
      }
    }
  }
}

TEST(ExitRows, AStateHeldFixedIsInTheOffset) {
  const auto kernel = evaluation::ModelKernel::compile(with_a_neighbour());
  ASSERT_TRUE(kernel.has_value());
  ExitRows rows(*kernel);
  for (const double value : {2.0, -1.0, 2.0}) {
    const auto* row = rows.of(1, 1.0, {0, value}, {0.0, 0.5}, ExitRows::Rows::lasting);
    ASSERT_NE(row, nullptr);
    EXPECT_DOUBLE_EQ(row->offset, 7.0 * value - 1.0);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
