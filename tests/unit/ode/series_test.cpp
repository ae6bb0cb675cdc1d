// Taylor series of affine equations, x' = A x + b + c t, against their solutions.
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

/// A field with its linear part, which the stepper is handed beside it.
struct Affine {
  std::size_t n;
  std::vector<double> matrix;  ///< row by row
  std::vector<double> constant, rate;

  void operator()(double t, const double* x, double* xdot) const {
    for (std::size_t i = 0; i < n; ++i) {
      xdot[i] = constant[i] + rate[i] * t;
      for (std::size_t j = 0; j < n; ++j) xdot[i] += matrix[i * n + j] * x[j];
    }
  }
  [[nodiscard]] LinearField linear() const {
    LinearField field;
    field.start.push_back(0);
    for (std::size_t i = 0; i < n; ++i) {
      field.diagonal.push_back(matrix[i * n + i]);
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i || matrix[i * n + j] == 0.0) continue;
        field.column.push_back(j);
        field.entry.push_back(matrix[i * n + j]);
      }
      field.start.push_back(field.column.size());
      if (rate[i] != 0.0) field.rate = rate;
    }
    return field;
  }
};

/// An oscillator (0, 1) of angular frequency 2, decay (2) with rate 1/2 towards t, and a constant (3), from any start.
struct Known : Affine {
  Known()
      : Affine{4,
               {0.0, 2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0},
               {0.0, 0.0, 0.25, 0.0},
               {0.0, 0.0, 0.5, 0.0}} {}
  /// x2' = 1/4 + t/2 - x2/2: t - 3/2 and what decays.
  [[nodiscard]] static std::vector<double> exact(double t) {
    return {std::sin(2.0 * t), std::cos(2.0 * t), t - 1.5 + 2.0 * std::exp(-0.5 * t), 0.7};
  }
};

/// The three components of a decay chain, which has no entry but on and below the diagonal.
Affine chain() { return {3, {-1.0, 0.0, 0.0, 1.0, -2.0, 0.0, 0.0, 0.5, -3.0}, {0.3, 0.0, -0.1}, {0.0, 0.0, 0.0}}; }

Attempt attempt(Stepper& stepper, const Affine& field, const LinearField& linear, double t,
                const std::vector<double>& x, double h, const Tolerances& tolerances = {}) {
  std::vector<double> slope(x.size());
  field(t, x.data(), slope.data());
  return stepper.attempt(field, t, x.data(), slope.data(), h, tolerances, {{}, nullptr, &linear});
}

std::vector<double> result_of(const Stepper& stepper, std::size_t n) { return {stepper.x_new(), stepper.x_new() + n}; }

TEST(Series, one_step_has_the_error_of_the_first_neglected_power) {
  const Known field;
  const auto linear = field.linear();
  const auto error = [&](double h) {
    Stepper stepper(Method::taylor, 4);
    EXPECT_EQ(attempt(stepper, field, linear, 0.3, Known::exact(0.3), h), Attempt::finite);
    EXPECT_EQ(stepper.method(), Method::taylor);
    return distance(stepper.x_new(), Known::exact(0.3 + h));
  };
  // (2 h)^17 / 17! is 5e-10 at h = 1 and 4e-8 at h = 1.3, far above rounding.
  EXPECT_NEAR(std::log(error(1.3) / error(1.0)) / std::log(1.3), order(Method::taylor) + 1, 0.7);
  // (2 h)^17 / 17! < epsilon: a few roundings of numbers of size 1.
  EXPECT_LT(error(0.25), 4 * epsilon);
}

TEST(Series, error_norm_bounds_the_error_and_falls_with_the_order) {
  const Known field;
  const auto linear = field.linear();
  const Tolerances tolerances{.rtol = 0.0, .atol = 1e-9};
  double before = 0.0;
  for (const double h : {2.0, 1.0, 0.5}) {
    Stepper stepper(Method::taylor, 4);
    ASSERT_EQ(attempt(stepper, field, linear, 0.3, Known::exact(0.3), h, tolerances), Attempt::finite);
    const double norm = stepper.error_norm();
    EXPECT_GT(norm * 1e-9, distance(stepper.x_new(), Known::exact(0.3 + h)) - 4 * epsilon) << h;
    // Powers 15 and 16 of the step.
    if (before > 0.0) {
      EXPECT_NEAR(std::log2(before / norm), order(Method::taylor) - 0.5, 0.6) << h;
    }
    before = norm;
  }
}

TEST(Series, integrates_what_decays_what_oscillates_and_what_drives_it) {
  const Known field;
  const auto linear = field.linear();
  for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
    Stepper stepper(Method::taylor, 4);
    StepControl control(Method::taylor);
    std::vector<double> x = Known::exact(0.0);
    double t = 0.0, h = 0.1;
    int steps = 0, rejected = 0;
    while (t < 20.0) {
      h = std::min(h, 20.0 - t);
      ASSERT_EQ(attempt(stepper, field, linear, t, x, h, {tolerance, tolerance}), Attempt::finite);
      const double error = stepper.error_norm();
      if (error > 1.0) {
        h *= control.rejected(error);
        ++rejected;
        continue;
      }
      t += h;
      ++steps;
      x = result_of(stepper, 4);
      h *= control.accepted(error);
    }
    // Errors of the steps, which the oscillator neither damps nor amplifies, and the roundings of 20.
    EXPECT_LT(distance(x.data(), Known::exact(t)), steps * (tolerance + 64 * epsilon)) << tolerance;
    EXPECT_LT(steps, 60) << tolerance;
    EXPECT_LT(rejected, 10) << tolerance;
  }
}

TEST(Series, further_lengths_from_a_start_have_the_bits_of_a_first_one) {
  const auto field = chain();
  const auto linear = field.linear();
  const std::vector<double> x{0.4, -0.2, 1.1};
  Stepper used(Method::taylor, 3);
  for (const double h : {0.37, 1.9, 2.1, 1e-3, 0.8}) {
    ASSERT_EQ(attempt(used, field, linear, 0.1, x, h), Attempt::finite);
    Stepper fresh(Method::taylor, 3);
    ASSERT_EQ(attempt(fresh, field, linear, 0.1, x, h), Attempt::finite);
    EXPECT_EQ(result_of(used, 3), result_of(fresh, 3)) << h;
    EXPECT_EQ(used.error_norm(), fresh.error_norm()) << h;
  }
}

TEST(Series, another_start_or_another_field_begins_anew) {
  const auto field = chain();
  auto other = field;
  other.matrix[4] = -5.0;
  other.constant[1] = 3.0 * -0.2;  // the same slope at the start
  const auto linear = field.linear(), other_linear = other.linear();
  const std::vector<double> x{0.4, -0.2, 1.1};
  Stepper stepper(Method::taylor, 3), fresh(Method::taylor, 3);
  ASSERT_EQ(attempt(stepper, field, linear, 0.1, x, 0.5), Attempt::finite);
  const auto first = result_of(stepper, 3);
  stepper.restart();
  ASSERT_EQ(attempt(stepper, other, other_linear, 0.1, x, 0.5), Attempt::finite);
  ASSERT_EQ(attempt(fresh, other, other_linear, 0.1, x, 0.5), Attempt::finite);
  EXPECT_NE(result_of(stepper, 3), first);
  EXPECT_EQ(result_of(stepper, 3), result_of(fresh, 3));
  // From its own end, which is handed over in place.
  ASSERT_EQ(stepper.attempt(other, 0.6, stepper.x_new(), stepper.slope_new(), 0.5, {}, {{}, nullptr, &other_linear}),
            Attempt::finite);
  ASSERT_EQ(attempt(fresh, other, other_linear, 0.6, result_of(fresh, 3), 0.5), Attempt::finite);
  EXPECT_EQ(result_of(stepper, 3), result_of(fresh, 3));
}

TEST(Series, evaluates_the_field_once_per_attempt_and_not_for_the_dense_output) {
  const Known field;
  const auto linear = field.linear();
  Stepper stepper(Method::taylor, 4);
  ASSERT_EQ(attempt(stepper, field, linear, 0.0, Known::exact(0.0), 0.5), Attempt::finite);
  EXPECT_EQ(stepper.evaluations(), 1);
  std::vector<double> slope(4);
  field(0.5, stepper.x_new(), slope.data());
  for (std::size_t i = 0; i < slope.size(); ++i) EXPECT_EQ(stepper.slope_new()[i], slope[i]);
  DenseStep dense;
  ASSERT_EQ(stepper.dense(field, dense), Attempt::finite);
  EXPECT_EQ(stepper.evaluations(), 1);
}

TEST(Series, dense_output_is_the_solution_all_along_the_step) {
  const Known field;
  const auto linear = field.linear();
  Stepper stepper(Method::taylor, 4);
  const auto start = Known::exact(0.3);
  ASSERT_EQ(attempt(stepper, field, linear, 0.3, start, 0.25), Attempt::finite);
  DenseStep dense;
  ASSERT_EQ(stepper.dense(field, dense), Attempt::finite);
  EXPECT_TRUE(dense.is_series());
  std::vector<double> x(4), slope(4), expected(4);
  dense.evaluate(0.0, x.data());
  EXPECT_EQ(x, start);
  dense.evaluate(1.0, x.data());
  EXPECT_EQ(x, result_of(stepper, 4));
  for (int k = 0; k <= 50; ++k) {
    const double t = 0.3 + 0.25 * k / 50.0;
    dense.evaluate(k / 50.0, x.data());
    EXPECT_LT(distance(x.data(), Known::exact(t)), 8 * epsilon) << k;
    EXPECT_EQ(x[3], 0.7);
    dense.derivative(k / 50.0, slope.data());
    field(t, Known::exact(t).data(), expected.data());
    EXPECT_LT(distance(slope.data(), expected), 32 * epsilon) << k;  // of slopes up to 2
    EXPECT_EQ(slope[3], 0.0);
  }
}

TEST(Series, components_and_their_mean_slopes_stay_within_their_bounds) {
  const Known field;
  const auto linear = field.linear();
  for (const double h : {1e-3, 0.1, 0.7, 1.6, -0.4}) {
    for (double t = 0.0; t < 4.0; t += 0.37) {
      Stepper stepper(Method::taylor, 4);
      const auto start = Known::exact(t);
      ASSERT_EQ(attempt(stepper, field, linear, t, start, h), Attempt::finite);
      DenseStep dense;
      ASSERT_EQ(stepper.dense(field, dense), Attempt::finite);
      std::array<double, 4> low, high, dense_low, dense_high, slope_low, slope_high, x;
      ASSERT_TRUE(stepper.bounds(low.data(), high.data()));
      ASSERT_TRUE(stepper.mean_slopes(slope_low.data(), slope_high.data()));
      dense.bounds(dense_low.data(), dense_high.data());
      EXPECT_EQ(low, dense_low);
      EXPECT_EQ(high, dense_high);
      std::array<double, 4> least = low, largest = high;
      least.fill(1e9);
      largest.fill(-1e9);
      for (int k = 0; k <= 200; ++k) {
        dense.evaluate(k / 200.0, x.data());
        for (std::size_t i = 0; i < 4; ++i) {
          const double rounding = 16 * epsilon * (2.0 + t);
          least[i] = std::min(least[i], x[i]);
          largest[i] = std::max(largest[i], x[i]);
          ASSERT_GE(x[i], low[i] - rounding) << h << ' ' << t << ' ' << k;
          ASSERT_LE(x[i], high[i] + rounding) << h << ' ' << t << ' ' << k;
          if (k == 0) continue;
          const double passed = h * k / 200.0;
          const double slope = (x[i] - start[i]) / passed;
          ASSERT_GE(slope, slope_low[i] - 2.0 * rounding / std::abs(passed)) << h << ' ' << t << ' ' << k;
          ASSERT_LE(slope, slope_high[i] + 2.0 * rounding / std::abs(passed)) << h << ' ' << t << ' ' << k;
        }
      }
      // They say something: Bernstein coefficients are at most about as far beyond the range as its curvature is high.
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_LE(high[i] - low[i], 1.0 * (largest[i] - least[i]) + h * h + 1e-9) << h << ' ' << t << ' ' << i;
      }
    }
  }
}

TEST(Series, powers_of_two_scale_exactly) {
  const auto field = chain();
  auto scaled = field;  // time in units of 2^-9, states of 2^20
  for (double& a : scaled.matrix) a *= 0x1p-9;
  for (double& b : scaled.constant) b *= 0x1p11;
  const auto linear = field.linear(), scaled_linear = scaled.linear();
  const std::vector<double> x{0.4, -0.2, 1.1};
  std::vector<double> x_scaled = x;
  for (double& value : x_scaled) value *= 0x1p20;
  Stepper one(Method::taylor, 3), two(Method::taylor, 3);
  ASSERT_EQ(attempt(one, field, linear, 0.1, x, 0.7, {1e-7, 1e-9}), Attempt::finite);
  ASSERT_EQ(attempt(two, scaled, scaled_linear, 0.1 * 0x1p9, x_scaled, 0.7 * 0x1p9, {1e-7, 1e-9 * 0x1p20}),
            Attempt::finite);
  EXPECT_EQ(one.error_norm(), two.error_norm());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(one.x_new()[i] * 0x1p20, two.x_new()[i]);
}

TEST(Series, a_component_has_the_same_bits_among_any_number_of_others) {
  const auto first_of = [](std::size_t n) {
    Affine field{n, std::vector<double>(n * n), std::vector<double>(n, 0.3), std::vector<double>(n)};
    for (std::size_t i = 0; i < n; ++i) field.matrix[i * n + i] = -1.0 - 0.1 * static_cast<double>(i);
    const auto linear = field.linear();
    Stepper stepper(Method::taylor, static_cast<int>(n));
    EXPECT_EQ(attempt(stepper, field, linear, 0.2, std::vector<double>(n, 0.8), 0.9), Attempt::finite);
    std::vector<double> low(n), high(n), inside(n);
    EXPECT_TRUE(stepper.bounds(low.data(), high.data()));
    DenseStep dense;
    EXPECT_EQ(stepper.dense(field, dense), Attempt::finite);
    dense.evaluate(0.3, inside.data());
    return std::vector<double>{stepper.x_new()[0], stepper.slope_new()[0], low[0], high[0], inside[0]};
  };
  const auto alone = first_of(1);
  for (std::size_t n = 2; n <= 10; ++n) EXPECT_EQ(first_of(n), alone) << n;
}

TEST(Series, stability_limits_the_steps_where_the_ratio_says_so) {
  // x' = -x beside a slow component: from h = 7.3 on, what should decay grows.
  const Affine field{2, {-1.0, 0.0, 0.0, -1e-3}, {0.0, 0.0}, {0.0, 0.0}};
  const auto linear = field.linear();
  for (const double h : {6.9, 7.8}) {
    Stepper stepper(Method::taylor, 2);
    ASSERT_EQ(attempt(stepper, field, linear, 0.0, {1.0, 1.0}, h), Attempt::finite);
    EXPECT_EQ(std::abs(stepper.x_new()[0]) > 1.0, h > 7.3) << h;
    EXPECT_NEAR(stepper.stability_ratio({1e-8, 1e-8}), h / 7.3, 0.01);
  }
}

TEST(Series, undefined_slopes_and_overflow_are_noticed) {
  const Affine field{1, {1e200}, {0.0}, {0.0}};
  const auto linear = field.linear();
  Stepper stepper(Method::taylor, 1);
  EXPECT_EQ(attempt(stepper, field, linear, 0.0, {1.0}, 1.0), Attempt::undefined);
  EXPECT_EQ(stepper.evaluations(), 0);
  const double x = 1.0, slope = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stepper.attempt(field, 0.0, &x, &slope, 0.1, {}, {{}, nullptr, &linear}), Attempt::undefined);
  // Nothing of it reaches the next attempt.
  EXPECT_EQ(attempt(stepper, field, linear, 0.0, {1.0}, 1e-200), Attempt::finite);
  EXPECT_NEAR(stepper.x_new()[0], std::exp(1.0), 1e-12);
}

TEST(Series, without_a_linear_part_steps_are_those_of_dop853) {
  const auto x = Kepler::exact(0.3);
  std::vector<double> slope(4);
  Kepler{}(0.3, x.data(), slope.data());
  Stepper taylor(Method::taylor, 4), pair(Method::dop853, 4);
  ASSERT_EQ(taylor.attempt(Kepler{}, 0.3, x.data(), slope.data(), 0.2, {}), Attempt::finite);
  ASSERT_EQ(pair.attempt(Kepler{}, 0.3, x.data(), slope.data(), 0.2, {}), Attempt::finite);
  EXPECT_EQ(taylor.method(), Method::dop853);
  EXPECT_EQ(result_of(taylor, 4), result_of(pair, 4));
  EXPECT_EQ(taylor.error_norm(), pair.error_norm());
  DenseStep one, other;
  ASSERT_EQ(taylor.dense(Kepler{}, one), Attempt::finite);
  ASSERT_EQ(pair.dense(Kepler{}, other), Attempt::finite);
  EXPECT_FALSE(one.is_series());
  std::vector<double> a(4), b(4);
  one.evaluate(0.4, a.data());
  other.evaluate(0.4, b.data());
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace saltus::ode
