// Steps by Taylor series where two selections vary, against closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/switching/hidden/hidden_series_internal.hpp"

namespace saltus::switching {
namespace {

constexpr double plenty = 30.0;

/// `rows` velocities, bilinear in two components, given by what they are at a point.
struct Rows {
  explicit Rows(std::vector<std::function<double(double, double)>> velocities)
      : of(std::move(velocities)), face(static_cast<int>(of.size()), 2) {
    for (std::size_t j = 0; j < of.size(); ++j) {
      for (std::size_t corner = 0; corner < 4; ++corner) {
        face.set_value(static_cast<int>(j), corner, of[j](corner & 1U ? 1.0 : 0.0, corner & 2U ? 1.0 : 0.0));
      }
    }
  }
  [[nodiscard]] std::vector<double> at(double x, double y) const {
    std::vector<double> v;
    for (const auto& velocity : of) v.push_back(velocity(x, y));
    return v;
  }
  std::vector<std::function<double(double, double)>> of;
  MultiAffine face;
};

/// Distance from `exact(t)` at eleven points of the step, each of them within its bounds.
template <class Exact>
double error(const PairSeries& series, std::size_t surfaces, Exact&& exact) {
  std::vector<double> u(surfaces);
  std::vector<double> low(surfaces);
  std::vector<double> high(surfaces);
  series.bounds(low.data(), high.data());
  double largest = 0.0;
  for (int i = 0; i <= 10; ++i) {
    series.evaluate(0.1 * i, u.data());
    const auto expected = exact(0.1 * i * series.h());
    for (std::size_t j = 0; j < surfaces; ++j) {
      largest = std::max(largest, std::abs(u[j] - expected[j]));
      EXPECT_LE(low[j], u[j] + 1e-15);
      EXPECT_GE(high[j], u[j] - 1e-15);
    }
  }
  return largest;
}

TEST(HiddenSeries, FollowsARotationToItsTolerance) {
  const Rows rows({[](double, double y) { return 0.5 - y; }, [](double x, double) { return x - 0.5; }});
  const std::vector<double> u{0.8, 0.5};
  PairSeries series(2);
  double h_before = plenty;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-11}) {
    series.take(rows.face, {0, 1}, u, rows.at(u[0], u[1]), tolerance, plenty);
    const auto exact = [](double t) { return std::array{0.5 + 0.3 * std::cos(t), 0.5 + 0.3 * std::sin(t)}; };
    EXPECT_LT(error(series, 2, exact), tolerance);
    EXPECT_GT(series.h(), 0.5);
    EXPECT_LT(series.h(), h_before);
    h_before = series.h();
  }
}

// x' = 1, y' = x y, and a saturated component between them with w' = x y: y = y_0 exp(x_0 t + t^2 / 2) = w + y_0 - w_0.
TEST(HiddenSeries, FollowsProductsAndSaturatedComponents) {
  const auto product = [](double x, double y) { return x * y; };
  const Rows rows({[](double, double) { return 1.0; }, product, product});
  const std::vector<double> u{0.3, -2.0, 0.6};
  PairSeries series(3);
  for (const double tolerance : {1e-6, 1e-10}) {
    series.take(rows.face, {0, 2}, u, rows.at(u[0], u[2]), tolerance, plenty);
    const auto exact = [&](double t) {
      const double y = u[2] * std::exp(u[0] * t + 0.5 * t * t);
      return std::array{u[0] + t, u[1] + y - u[2], y};
    };
    EXPECT_LT(error(series, 3, exact), tolerance);
    EXPECT_GT(series.h(), 0.2);
  }
}

TEST(HiddenSeries, IsAsLongAsItMayBeWhereVelocitiesAreConstant) {
  const Rows rows({[](double, double) { return 0.25; }, [](double, double) { return -1.0; }});
  const std::vector<double> u{0.5, 0.75};
  PairSeries series(2);
  series.take(rows.face, {0, 1}, u, rows.at(u[0], u[1]), 1e-10, plenty);
  EXPECT_NEAR(series.h(), plenty, 1e-12);
  EXPECT_LT(error(series, 2, [](double t) { return std::array{0.5 + 0.25 * t, 0.75 - t}; }), 1e-13);
}

}  // namespace
}  // namespace saltus::switching
