#include "saltus/switching/plane/intersection_roots.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "random_fields.hpp"
#include "switching_cases.hpp"

namespace saltus::switching {
namespace {

double interpolate(const std::array<double, 4>& f, double x, double y) {
  return (1 - x) * (1 - y) * f[0] + x * (1 - y) * f[1] + (1 - x) * y * f[2] + x * y * f[3];
}

/// alpha_1 of the roots in the square: along g_1 = 0, which is a graph over alpha_1, the sign changes of g_2.
std::vector<double> roots_by_scanning(const Velocities& f) {
  const auto height = [&f](double x) {
    const double low = (1 - x) * f[0][0] + x * f[0][1];
    const double high = (1 - x) * f[0][2] + x * f[0][3];
    return low / (low - high);
  };
  const auto value = [&](double x) { return interpolate(f[1], x, height(x)); };
  std::vector<double> roots;
  constexpr int samples = 4000;
  for (int i = 0; i < samples; ++i) {
    double left = static_cast<double>(i) / samples;
    double right = static_cast<double>(i + 1) / samples;
    const bool on_one_branch = std::abs(height(left) - height(right)) < 0.5;
    if (!on_one_branch || value(left) * value(right) > 0.0) continue;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (left + right);
      (value(left) * value(middle) <= 0.0 ? right : left) = middle;
    }
    if (height(left) > 0.0 && height(left) < 1.0) roots.push_back(left);
  }
  return roots;
}

TEST(IntersectionRoots, AreThoseThatAScanOfTheSquareFinds) {
  RandomFields random(3);
  int found = 0;
  for (int n = 0; n < 2000; ++n) {
    const Velocities f = random.fields();
    const auto roots = intersection_roots(plane_table(f));
    if (std::abs(roots.discriminant) < 1e-4) continue;  // closer than the scan resolves
    std::vector<double> ours;
    for (const auto& root : {roots.rising, roots.falling}) {
      if (root && root->inside()) ours.push_back(root->alpha[0]);
    }
    std::sort(ours.begin(), ours.end());
    const auto theirs = roots_by_scanning(f);
    ASSERT_EQ(ours.size(), theirs.size()) << n;
    for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(ours[i], theirs[i], 1e-12);
    found += static_cast<int>(ours.size());
  }
  EXPECT_GT(found, 700);
}

TEST(IntersectionRoots, ResidualJacobianAndDeterminant) {
  RandomFields random(4);
  for (int n = 0; n < 20000; ++n) {
    const Velocities f = random.fields();
    const auto roots = intersection_roots(plane_table(f));
    EXPECT_EQ(roots.rising.has_value(), roots.discriminant >= 0.0);
    if (!roots.rising || !roots.falling) continue;
    double scale = 1.0;
    for (const auto& row : f) scale *= std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0));
    // The two roots have opposite signs of det G, and its square is the discriminant.
    EXPECT_GT(roots.rising->determinant, 0.0);
    EXPECT_LT(roots.falling->determinant, 0.0);
    for (const auto& root : {*roots.rising, *roots.falling}) {
      const auto [x, y] = root.alpha;
      const double size = (1 + std::abs(x)) * (1 + std::abs(y));
      const auto& g = root.sliding_jacobian;
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(interpolate(f[j], x, y), 0.0, 1e-14 * size * size);
        EXPECT_NEAR(g[j][0], interpolate(f[j], x + 1, y) - interpolate(f[j], x, y), 1e-13 * size);
        EXPECT_NEAR(g[j][1], interpolate(f[j], x, y + 1) - interpolate(f[j], x, y), 1e-13 * size);
      }
      const double det = root.determinant / scale;
      if (std::abs(det) > 1e-3 && size < 100.0) {
        EXPECT_NEAR(det * det / roots.discriminant, 1.0, 1e-9);
      }
    }
  }
}

TEST(IntersectionRoots, ScalingByPowersOfTwoChangesNothing) {
  RandomFields random(5);
  for (int n = 0; n < 1000; ++n) {
    Velocities f = random.fields();
    const auto before = intersection_roots(plane_table(f));
    for (double& velocity : f[0]) velocity = std::ldexp(velocity, 300);
    for (double& velocity : f[1]) velocity = std::ldexp(velocity, -290);
    const auto after = intersection_roots(plane_table(f));
    ASSERT_EQ(before.rising.has_value(), after.rising.has_value());
    EXPECT_EQ(before.discriminant, after.discriminant);
    if (!before.rising) continue;
    EXPECT_EQ(before.rising->alpha, after.rising->alpha);
    EXPECT_EQ(before.rising->sliding_jacobian[0][1], std::ldexp(after.rising->sliding_jacobian[0][1], -300));
  }
}

TEST(IntersectionRoots, DoubleRootToTheSquareRootOfRounding) {
  // g_1 = alpha_2 - alpha_1^... touches: g_1 = alpha_1 - alpha_2, g_2 = alpha_1 (1 - alpha_2) - 1/4 - s: roots at
  // alpha_1 = alpha_2 = 1/2 -+ sqrt(-s).
  for (const double s : {-1e-2, -1e-8, -1e-14, 1e-14, 1e-8}) {
    const Velocities f{{{0.0, 1.0, -1.0, 0.0}, {-0.25 - s, 0.75 - s, -0.25 - s, -0.25 - s}}};
    const auto roots = intersection_roots(plane_table(f));
    EXPECT_EQ(roots.rising.has_value(), s < 0.0) << s;
    if (!roots.rising) continue;
    const double distance = std::abs(roots.rising->alpha[0] - 0.5);
    EXPECT_NEAR(distance, std::sqrt(-s), 1e-15 / std::sqrt(-s)) << s;
    EXPECT_NEAR(roots.rising->alpha[1], roots.rising->alpha[0], 1e-15 / std::sqrt(-s)) << s;
  }
}

TEST(IntersectionRoots, NoneWhereTheFieldsAgree) {
  EXPECT_FALSE(intersection_roots(plane_table(Velocities{})).rising.has_value());
  const auto parallel = intersection_roots(plane_table({{{-1.0, 1.0, -1.0, 1.0}, {-2.0, 2.0, -2.0, 2.0}}}));
  EXPECT_FALSE(parallel.rising && parallel.rising->inside());
}

TEST(IntersectionRoots, StabilityForSomeScaling) {
  // G = (-1, 0; 0, 2)-like with det > 0: fields f_1 = -u_1 - 2 u_2, f_2 = 2 u_1 + u_2 about the centre.
  const auto table = plane_table({{{3.0, 1.0, -1.0, -3.0}, {-3.0, 1.0, -1.0, 3.0}}});
  const auto root = intersection_roots(table).rising;
  ASSERT_TRUE(root);
  EXPECT_DOUBLE_EQ(root->alpha[0], 0.5);
  EXPECT_TRUE(root->stabilisable());
}

TEST(IntersectionRoots, WhereTheRootsMeetAndPartTheRisingOneIsTaken) {
  int cases = 0;
  for (const SwitchingCase& c : plane_cases()) {
    if (c.situation != "exit_codim2_c1_root_reselection") continue;
    const auto roots = intersection_roots(plane_table(c.f));
    ASSERT_TRUE(roots.rising && roots.falling) << c.id;
    const auto rejected = c.all["lambda_rejected"].get<std::array<double, 2>>();
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(2.0 * roots.rising->alpha[j] - 1.0, c.expected[0].lambda[j], 1e-9) << c.id;
      EXPECT_NEAR(2.0 * roots.falling->alpha[j] - 1.0, rejected[j], 1e-9) << c.id;
    }
    ++cases;
  }
  EXPECT_EQ(cases, 10);
}

}  // namespace
}  // namespace saltus::switching
