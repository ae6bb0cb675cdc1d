#include "saltus/switching/selections/selection_newton.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hidden_instances.hpp"
#include "saltus/switching/plane/intersection_roots.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

TEST(SelectionNewton, FollowsTheRisingRootOfTwoSurfaces) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> velocity(-1.0, 1.0);
  SelectionNewton newton(2);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    std::array<std::array<double, 4>, 2> f{};
    MultiAffine g(2, 2);
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 4; ++k) g.set_value(static_cast<int>(j), k, f[j][k] = velocity(random));
    }
    const auto roots = intersection_roots(plane_table(f));
    if (!roots.rising || !roots.rising->inside() || roots.discriminant < 1e-3) continue;
    PlaneAlpha alpha = roots.rising->alpha;
    alpha[0] += 0.01;
    alpha[1] -= 0.01;
    ASSERT_TRUE(newton.solve([&](const double* a, double* v) { g.evaluate(a, v); }, alpha.data()));
    for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(alpha[j], roots.rising->alpha[j], 1e-12);
    EXPECT_NEAR(newton.determinant(), roots.rising->determinant, 1e-6);
    EXPECT_EQ(newton.margin() > 0.0, roots.rising->stabilisable());
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(SelectionNewton, ThreeSurfacesToRoundingInFewEvaluations) {
  for (const auto& one : random_entries(3, 300, 2)) {
    const auto decision = one.decide();
    if (decision.limit != HiddenLimit::settled || decision.mode != std::vector<int>(3, 0)) continue;
    SelectionNewton newton(3);
    std::vector<double> alpha = decision.alpha;
    for (double& a : alpha) a += 1e-4;
    ASSERT_TRUE(newton.solve([&](const double* a, double* v) { one.g.evaluate(a, v); }, alpha.data()));
    std::array<double, 3> g{};
    one.g.evaluate(alpha.data(), g.data());
    for (const double value : g) EXPECT_NEAR(value, 0.0, 4e-15);
    EXPECT_LE(newton.evaluations(), 6 * 4);
  }
}

TEST(SelectionNewton, TellsARootFromItsTwinCloseBy) {
  // With both selections s: (s - 1/2 - d)(s - 1/2 + d). Until it is as close as that, a step only halves the way.
  constexpr double d = 1e-7;
  const auto g = [](const double* a, double* v) {
    v[0] = (a[0] - 0.5) * (a[1] - 0.5) - d * d;
    v[1] = a[0] - a[1];
  };
  SelectionNewton newton(2);
  for (const double start : {0.6, 0.51, 0.5 + 3e-7}) {
    std::array<double, 2> alpha{start, start};
    ASSERT_TRUE(newton.solve(g, alpha.data()));
    // Rounding of 1/2 over the slope 2 d is 1e-9 of it.
    EXPECT_NEAR(alpha[0] - 0.5, d, 0.01 * d) << start;
    EXPECT_NEAR(alpha[1] - 0.5, d, 0.01 * d) << start;
  }
}

TEST(SelectionNewton, SaysWhereThereIsNoRoot) {
  SelectionNewton newton(2);
  std::array<double, 2> alpha{0.5, 0.5};
  // g_1 = alpha_1 - alpha_2, g_2 = (alpha_1 - 1/2) (alpha_2 - 1/2) + 1/10: positive along g_1 = 0.
  const auto g = [](const double* a, double* v) {
    v[0] = a[0] - a[1];
    v[1] = (a[0] - 0.5) * (a[1] - 0.5) + 0.1;
  };
  EXPECT_FALSE(newton.solve(g, alpha.data()));
}

TEST(MatrixStability, HurwitzAgreesWithConstructedEigenvalues) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  for (int n = 1; n <= 6; ++n) {
    for (int i = 0; i < 50; ++i) {
      // S T S^-1 with T block triangular: eigenvalues are its diagonal and a pair with real part `pair`.
      const auto size = static_cast<std::size_t>(n);
      std::vector<double> t(size * size);
      bool stable = true;
      for (std::size_t r = 0; r < size; ++r) {
        for (std::size_t c = r; c < size; ++c) t[r * size + c] = entry(random);
        stable = stable && t[r * size + r] < 0.0;
      }
      if (n >= 2) {
        const double pair = t[0];
        t[size + 1] = pair;
        t[1] = 3.0;
        t[size] = -2.0;
        stable = pair < 0.0;
        for (std::size_t r = 2; r < size; ++r) stable = stable && t[r * size + r] < 0.0;
      }
      // A = S T S^-1 for S = I + e v', S^-1 = I - e v' / (1 + v'e): similar, and full.
      std::vector<double> v(size);
      for (double& x : v) x = entry(random);
      const std::size_t e = size - 1;
      std::vector<double> st = t;
      for (std::size_t c = 0; c < size; ++c) {
        for (std::size_t r = 0; r < size; ++r) st[e * size + c] += v[r] * t[r * size + c];
      }
      std::vector<double> a = st;
      for (std::size_t r = 0; r < size; ++r) {
        for (std::size_t c = 0; c < size; ++c) a[r * size + c] -= st[r * size + e] * v[c] / (1.0 + v[e]);
      }
      EXPECT_EQ(is_hurwitz(a, n), stable) << n;
      EXPECT_EQ(hurwitz_margin(a, n) > 0.0, stable) << n;
    }
  }
}

TEST(MatrixStability, TwoByTwoMarginIsTheCriterionForStability) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const std::array<double, 4> g{entry(random), entry(random), entry(random), entry(random)};
    const bool wanted = g[0] * g[3] - g[1] * g[2] > 0.0 && std::min(g[0], g[3]) < 0.0;
    EXPECT_EQ(fisher_fuller_margin(g, 2) > 0.0, wanted);
  }
}

TEST(MatrixStability, PositiveMarginMeansThatSomeScalingStabilises) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  int positive = 0;
  for (int i = 0; i < 400; ++i) {
    std::array<double, 9> a{};
    for (double& x : a) x = entry(random);
    bool found = false;
    for (int first = -8; first <= 8 && !found; ++first) {
      for (int second = -8; second <= 8 && !found; ++second) {
        std::array<double, 9> scaled = a;
        for (std::size_t c = 0; c < 3; ++c) {
          scaled[c] *= std::pow(10.0, 0.5 * first);
          scaled[3 + c] *= std::pow(10.0, 0.5 * second);
        }
        found = is_hurwitz(scaled, 3);
      }
    }
    const double margin = fisher_fuller_margin(a, 3);
    if (margin > 0.02) {  // smaller ones need scalings beyond the grid
      ++positive;
      EXPECT_TRUE(found) << margin;
    }
    std::array<double, 9> rows = a;
    for (std::size_t c = 0; c < 3; ++c) rows[c] *= 0x1p20;
    EXPECT_EQ(fisher_fuller_margin(rows, 3), margin);
  }
  EXPECT_GT(positive, 40);
}

}  // namespace
}  // namespace saltus::switching
