#include "saltus/ode/sparse/jacobian_pattern.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/ode/stepper.hpp"

namespace saltus::ode {
namespace {

TEST(JacobianPattern, HoldsTheDiagonalAndEveryPairOnce) {
  const auto pattern = pattern_of(3, {{2, 0}, {2, 0}, {0, 1}});
  EXPECT_EQ(pattern.start, (std::vector<std::size_t>{0, 2, 4, 5}));
  EXPECT_EQ(pattern.row, (std::vector<std::size_t>{0, 2, 0, 1, 2}));
}

/// Three groups do for a tridiagonal matrix of any size: linear in the size is what large systems need.
TEST(JacobianPattern, ColumnsOfAGroupShareNoRow) {
  std::vector<std::pair<std::size_t, std::size_t>> entries;
  constexpr std::size_t n = 200;
  for (std::size_t i = 1; i < n; ++i) {
    entries.emplace_back(i, i - 1);
    entries.emplace_back(i - 1, i);
  }
  const auto pattern = pattern_of(n, entries);
  const auto groups = column_groups(pattern);
  EXPECT_EQ(groups.size(), 3U);
  std::size_t columns = 0;
  for (const auto& group : groups) {
    std::vector<bool> taken(n, false);
    for (const std::size_t column : group) {
      ++columns;
      for (std::size_t k = pattern.start[column]; k < pattern.start[column + 1]; ++k) {
        EXPECT_FALSE(taken[pattern.row[k]]);
        taken[pattern.row[k]] = true;
      }
    }
  }
  EXPECT_EQ(columns, n);
}

/// One step of the heat equation with a source: the same with dense matrices, to the accuracy of the iteration, and
/// with fewer evaluations.
TEST(JacobianPattern, SparseStepsOfRadau5AreTheDenseOnes) {
  constexpr int n = 60;
  const auto f = [](double t, const double* x, double* xdot) {
    for (int i = 0; i < n; ++i) {
      const double left = i > 0 ? x[i - 1] : 1.0;
      const double right = i + 1 < n ? x[i + 1] : x[i];
      xdot[i] = 3600.0 * (left - 2.0 * x[i] + right) - x[i] * x[i] * x[i] + std::sin(t);
    }
  };
  std::vector<std::pair<std::size_t, std::size_t>> entries;
  for (std::size_t i = 1; i < n; ++i) {
    entries.emplace_back(i, i - 1);
    entries.emplace_back(i - 1, i);
  }
  const auto pattern = pattern_of(n, entries);
  std::vector<double> x(n, 0.2), slope(n);
  f(0.0, x.data(), slope.data());
  Stepper dense(Method::radau5, n), sparse(Method::radau5, n);
  const Tolerances tolerances{1e-8, 1e-10};
  ASSERT_TRUE(sparse.wants_pattern());
  double h = 1e-3;
  for (int step = 0; step < 3; ++step, h *= 1.5) {
    const double t = dense.start_time() + dense.length();
    ASSERT_EQ(dense.attempt(f, t, x.data(), slope.data(), h, tolerances), Attempt::finite);
    ASSERT_EQ(sparse.attempt(f, t, x.data(), slope.data(), h, tolerances, {.functions = {}, .pattern = &pattern}),
              Attempt::finite);
    for (int i = 0; i < n; ++i) EXPECT_NEAR(sparse.x_new()[i], dense.x_new()[i], 1e-13) << i;
    x.assign(dense.x_new(), dense.x_new() + n);
    slope.assign(dense.slope_new(), dense.slope_new() + n);
  }
  EXPECT_LT(sparse.evaluations(), dense.evaluations() / 2);
}

}  // namespace
}  // namespace saltus::ode
