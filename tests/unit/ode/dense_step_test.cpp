#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

class DenseOutput : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(DenseStep, DenseOutput, ::testing::ValuesIn(all_methods));

DenseStep one_step(Stepper& stepper, RightHandSide f, double t, const std::vector<double>& x, double h,
                   const Tolerances& tolerances = {}) {
  std::vector<double> slope(x.size());
  f(t, x.data(), slope.data());
  EXPECT_EQ(stepper.attempt(f, t, x.data(), slope.data(), h, tolerances), Attempt::finite);
  DenseStep dense;
  EXPECT_EQ(stepper.dense(f, dense), Attempt::finite);
  return dense;
}

DenseStep kepler_step(Method method, double t, double h) {
  Stepper stepper(method, Kepler::n);
  return one_step(stepper, Kepler{}, t, Kepler::exact(t), h);
}

TEST_P(DenseOutput, is_exact_at_both_ends) {
  Stepper stepper(GetParam(), Kepler::n);
  const auto start = Kepler::exact(0.3);
  const DenseStep dense = one_step(stepper, Kepler{}, 0.3, start, 0.2);
  EXPECT_EQ(dense.size(), Kepler::n);
  EXPECT_EQ(dense.t, 0.3);
  EXPECT_EQ(dense.h, 0.2);
  std::vector<double> x(start.size());
  dense.evaluate(0.0, x.data());
  EXPECT_EQ(x, start);
  dense.evaluate(1.0, x.data());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(x[i], stepper.x_new()[i]);
  // The slopes at the ends are those of the right-hand side: a few roundings of a difference of states over h.
  std::vector<double> slope(x.size());
  std::vector<double> expected(x.size());
  dense.derivative(1.0, slope.data());
  EXPECT_LT(distance(stepper.slope_new(), slope), rounding_growth(GetParam()) * 64 * epsilon / dense.h);
  if (is_implicit(GetParam())) return;  // a collocation polynomial, from the start's value and the stages' slopes
  dense.derivative(0.0, slope.data());
  Kepler{}(0.3, start.data(), expected.data());
  EXPECT_LT(distance(expected.data(), slope), 64 * epsilon / dense.h);
}

/// Calls visit(stepper, start, dense, t) for steps of several lengths from places all along the orbit.
template <class Visit>
void for_steps_along_the_orbit(Method method, Visit&& visit) {
  for (const double h : {1e-3, 0.1, 0.5, 1.0}) {
    if (is_implicit(method) && h > 0.5) continue;  // its stages are not found at every t
    for (double t = 0.0; t < 6.0; t += 0.37) {
      Stepper stepper(method, Kepler::n);
      const auto start = Kepler::exact(t);
      visit(stepper, start, one_step(stepper, Kepler{}, t, start, h), t);
    }
  }
}

TEST_P(DenseOutput, leaves_its_start_with_slopes_within_their_bounds) {
  for_steps_along_the_orbit(GetParam(), [](Stepper& stepper, const auto& start, const DenseStep& dense, double t) {
    const double h = dense.h;
    std::vector<double> low(start.size()), high(start.size()), x(start.size());
    ASSERT_EQ(stepper.mean_slopes(low.data(), high.data()), !is_implicit(GetParam()));
    if (is_implicit(GetParam())) return;
    for (int k = 1; k <= 200; ++k) {
      const double passed = h * k / 200.0;
      dense.evaluate(k / 200.0, x.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double slope = (x[i] - start[i]) / passed;
        const double rounding = 16 * epsilon / passed;
        ASSERT_GE(slope, low[i] - rounding) << "h = " << h << ", t = " << t << ", " << k;
        ASSERT_LE(slope, high[i] + rounding) << "h = " << h << ", t = " << t << ", " << k;
      }
    }
    // They say something: for a short step no more than the slopes at its ends, about.
    if (h > 1e-3) return;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double bend = std::abs(stepper.slope_new()[i] - (x[i] - start[i]) / h);
      EXPECT_LE(high[i] - low[i], 8.0 * bend + 64 * epsilon / h) << i;
    }
  });
}

TEST_P(DenseOutput, stays_within_its_bounds) {
  for_steps_along_the_orbit(GetParam(), [](Stepper& stepper, const auto& start, const DenseStep& dense, double t) {
    const double h = dense.h;
    std::vector<double> low(start.size()), high(start.size()), early_low(start.size()), early_high(start.size());
    dense.bounds(low.data(), high.data());
    const bool early = stepper.bounds(early_low.data(), early_high.data());
    EXPECT_EQ(early, !is_implicit(GetParam()));
    std::vector<double> x(start.size());
    for (int k = 0; k <= 200; ++k) {
      dense.evaluate(k / 200.0, x.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_GE(x[i], low[i] - 16 * epsilon) << "h = " << h << ", t = " << t << ", " << k;
        ASSERT_LE(x[i], high[i] + 16 * epsilon) << "h = " << h << ", t = " << t << ", " << k;
        if (!early) continue;
        ASSERT_GE(x[i], early_low[i] - 16 * epsilon) << "h = " << h << ", t = " << t << ", " << k;
        ASSERT_LE(x[i], early_high[i] + 16 * epsilon) << "h = " << h << ", t = " << t << ", " << k;
      }
    }
  });
}

TEST_P(DenseOutput, both_ways_of_writing_it_meet_in_the_middle) {
  const DenseStep dense = kepler_step(GetParam(), 0.0, 0.3);
  std::vector<double> left(Kepler::n);
  std::vector<double> right(Kepler::n);
  dense.evaluate(0.5, left.data());
  dense.evaluate(std::nextafter(0.5, 1.0), right.data());
  EXPECT_LT(distance(left.data(), right), 16 * epsilon);
}

double interior_error(Method method, double h) {
  const DenseStep dense = kepler_step(method, 1.0, h);
  double error = 0.0;
  std::vector<double> x(Kepler::n);
  for (int k = 1; k < 16; ++k) {
    dense.evaluate(k / 16.0, x.data());
    error = std::max(error, distance(x.data(), Kepler::exact(1.0 + h * k / 16.0)));
  }
  return error;
}

double slope_error(Method method, double h) {
  const DenseStep dense = kepler_step(method, 1.0, h);
  double error = 0.0;
  std::vector<double> expected(Kepler::n);
  std::vector<double> slope(Kepler::n);
  for (int k = 1; k < 16; ++k) {
    dense.derivative(k / 16.0, slope.data());
    Kepler{}(0.0, Kepler::exact(1.0 + h * k / 16.0).data(), expected.data());
    error = std::max(error, distance(slope.data(), expected));
  }
  return error;
}

TEST_P(DenseOutput, interior_error_of_one_step_is_of_order_degree_plus_one) {
  const double h = GetParam() == Method::radau13 ? 0.25 : 0.1;  // far from rounding
  EXPECT_NEAR(std::log2(interior_error(GetParam(), h) / interior_error(GetParam(), h / 2)),
              dense_degree(GetParam()) + 1, 0.35);
  EXPECT_NEAR(std::log2(slope_error(GetParam(), h) / slope_error(GetParam(), h / 2)), dense_degree(GetParam()), 0.3);
}

TEST_P(DenseOutput, interior_error_of_a_run_falls_with_the_degree) {
  // Global error at interior points of the last of equal steps up to t = 1: min(order, degree + 1) at least.
  const auto error = [&](int steps) {
    const double h = 1.0 / steps;
    const auto x = fixed_steps(GetParam(), Kepler{}, Kepler::exact(0.0), 0.0, 1.0 - h, steps - 1);
    Stepper stepper(GetParam(), Kepler::n);
    const DenseStep dense = one_step(stepper, Kepler{}, 1.0 - h, x, h);
    std::vector<double> middle(Kepler::n);
    dense.evaluate(0.4, middle.data());
    return distance(middle.data(), Kepler::exact(1.0 - 0.6 * h));
  };
  const int steps = GetParam() == Method::dopri5 ? 16 : 6;
  EXPECT_GT(std::log2(error(steps) / error(2 * steps)), dense_degree(GetParam()));
}

TEST_P(DenseOutput, a_part_of_it_is_the_same_polynomial) {
  const DenseStep whole = kepler_step(GetParam(), 0.2, 0.3);
  DenseStep part = whole;
  part.cut(0.25, 0.75);
  EXPECT_DOUBLE_EQ(part.t, 0.2 + 0.25 * 0.3);
  EXPECT_DOUBLE_EQ(part.h, 0.15);
  std::vector<double> expected(Kepler::n), found(Kepler::n), slope(Kepler::n), slope_found(Kepler::n);
  for (const double theta : {0.0, 0.1, 0.5, 0.8, 1.0}) {
    whole.evaluate(0.25 + 0.5 * theta, expected.data());
    part.evaluate(theta, found.data());
    whole.derivative(0.25 + 0.5 * theta, slope.data());
    part.derivative(theta, slope_found.data());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], 64 * epsilon) << theta;
      EXPECT_NEAR(slope_found[i], slope[i], 4096 * epsilon) << theta;
      EXPECT_EQ(part.value(i, theta), found[i]) << theta;
    }
  }
  DenseStep behind = whole;
  behind.cut(0.5, 1.0);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(behind.end(i), whole.end(i));
}

TEST_P(DenseOutput, components_are_replaced) {
  DenseStep whole = kepler_step(GetParam(), 0.2, 0.3);
  const DenseStep other = kepler_step(GetParam(), 1.0, 0.3);
  whole.replace(1, other, 2);
  for (const double theta : {0.0, 0.3, 0.9, 1.0}) EXPECT_EQ(whole.value(1, theta), other.value(2, theta));
}

TEST_P(DenseOutput, an_attempt_may_follow_it) {
  const DenseStep known = kepler_step(GetParam(), 0.2, 0.3);
  Stepper stepper(GetParam(), Kepler::n);
  stepper.follow(known, 0.12);
  EXPECT_TRUE(stepper.follows());
  EXPECT_EQ(stepper.error_norm(), 0.0);
  std::vector<double> expected(Kepler::n), low(Kepler::n), high(Kepler::n);
  known.evaluate(0.12 / 0.3, expected.data());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(stepper.x_new()[i], expected[i]);
  DenseStep part;
  ASSERT_EQ(stepper.dense(Kepler{}, part), Attempt::finite);
  ASSERT_TRUE(stepper.bounds(low.data(), high.data()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(part.end(i), expected[i]);
    EXPECT_LE(low[i], part.value(i, 0.5));
    EXPECT_GE(high[i], part.value(i, 0.5));
  }
  const auto x = Kepler::exact(0.2);
  std::vector<double> slope(Kepler::n);
  Kepler{}(0.2, x.data(), slope.data());
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.2, x.data(), slope.data(), 0.12, {}), Attempt::finite);
  EXPECT_FALSE(stepper.follows());
}

// x = t^d from t = 1/2 in one step of length 1, at all thetas.
double power_error(Method method, int degree) {
  const auto f = [&](double t, const double*, double* xdot) { *xdot = degree * std::pow(t, degree - 1); };
  Stepper stepper(method, 1);
  const DenseStep dense = one_step(stepper, f, 0.5, {std::pow(0.5, degree)}, 1.0);
  double error = 0.0;
  for (int k = 0; k <= 32; ++k) {
    double x = 0.0;
    dense.evaluate(k / 32.0, &x);
    error = std::max(error, std::abs(x - std::pow(0.5 + k / 32.0, degree)));
  }
  return error / std::pow(1.5, degree);
}

TEST_P(DenseOutput, reproduces_powers_up_to_its_degree_and_no_further) {
  // DOP853's upper coefficients are sums of terms up to 500 times as large as the slopes.
  for (int degree = 0; degree <= dense_degree(GetParam()); ++degree) {
    EXPECT_LT(power_error(GetParam(), degree), 1000 * epsilon) << degree;
  }
  EXPECT_GT(power_error(GetParam(), dense_degree(GetParam()) + 1), 1e-6);
}

TEST_P(DenseOutput, derivative_is_that_of_the_polynomial) {
  const DenseStep dense = kepler_step(GetParam(), 0.0, 0.35);
  std::vector<double> above(Kepler::n);
  std::vector<double> below(Kepler::n);
  std::vector<double> slope(Kepler::n);
  constexpr double width = 1e-4;  // error of the central difference: third derivatives, about 10, times width^2
  for (const double theta : {0.1, 0.35, 0.5, 0.8}) {
    dense.evaluate(theta + width, above.data());
    dense.evaluate(theta - width, below.data());
    dense.derivative(theta, slope.data());
    for (std::size_t i = 0; i < slope.size(); ++i) {
      EXPECT_NEAR(slope[i], (above[i] - below[i]) / (2.0 * width * dense.h), 1e-7);
    }
  }
}

TEST_P(DenseOutput, bernstein_form_is_the_polynomial) {
  const DenseStep dense = kepler_step(GetParam(), 0.3, 0.35);
  std::vector<double> x(Kepler::n), start(Kepler::n), end(Kepler::n);
  dense.evaluate(0.0, start.data());
  dense.evaluate(1.0, end.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto b = dense.bernstein(i);
    EXPECT_EQ(b.front(), start[i]);
    EXPECT_EQ(b.back(), end[i]);
    for (int k = 1; k < 32; ++k) {
      dense.evaluate(k / 32.0, x.data());
      EXPECT_NEAR(evaluate(b, k / 32.0), x[i], 16 * epsilon);  // of states of the order of one
    }
  }
}

TEST_P(DenseOutput, components_without_slope_are_constant) {
  const auto f = [](double t, const double* x, double* xdot) {
    xdot[0] = -x[0] + t;
    xdot[1] = 0.0;
    xdot[2] = -0.0;
    xdot[3] = 0.0 * x[0];
  };
  Stepper stepper(GetParam(), 4);
  const std::vector<double> start{1.0, 0.1, -1.0 / 3.0, 0.0};
  const DenseStep dense = one_step(stepper, f, 0.1, start, 0.77);
  std::vector<double> x(4);
  for (int k = 0; k <= 1000; ++k) {
    dense.evaluate(k / 1000.0, x.data());
    for (std::size_t i = 1; i < x.size(); ++i) ASSERT_EQ(x[i], start[i]) << "theta " << k / 1000.0;
    dense.derivative(k / 1000.0, x.data());
    for (std::size_t i = 1; i < x.size(); ++i) ASSERT_EQ(x[i], 0.0);
  }
}

TEST_P(DenseOutput, powers_of_two_scale_exactly) {
  const auto f = [](double t, const double* x, double* xdot) { *xdot = std::sin(*x) + t; };
  const auto scaled = [&](double t, const double* x, double* xdot) {
    const double in = *x * 0x1p20;
    f(t * 0x1p-7, &in, xdot);
    *xdot *= 0x1p-27;
  };
  Stepper stepper(GetParam(), 1);
  const DenseStep plain = one_step(stepper, f, 0.5, {0.3}, 0.25);
  const DenseStep other =
      one_step(stepper, scaled, 0.5 * 0x1p7, {0.3 * 0x1p-20}, 0.25 * 0x1p7, {.rtol = 1e-8, .atol = 1e-10 * 0x1p-20});
  for (int k = 0; k <= 100; ++k) {
    double x = 0.0;
    double y = 0.0;
    plain.evaluate(k / 100.0, &x);
    other.evaluate(k / 100.0, &y);
    EXPECT_EQ(x * 0x1p-20, y);
    plain.derivative(k / 100.0, &x);
    other.derivative(k / 100.0, &y);
    EXPECT_EQ(x * 0x1p-27, y);
  }
}

TEST_P(DenseOutput, is_a_value) {
  Stepper stepper(GetParam(), Kepler::n);
  const DenseStep first = one_step(stepper, Kepler{}, 0.0, Kepler::exact(0.0), 0.1);
  std::vector<double> before(Kepler::n);
  first.evaluate(0.3, before.data());
  static_cast<void>(one_step(stepper, Kepler{}, 1.0, Kepler::exact(1.0), 0.1));
  std::vector<double> after(Kepler::n);
  first.evaluate(0.3, after.data());
  EXPECT_EQ(before, after);
}

TEST(Dop853DenseOutput, undefined_extra_stages_are_noticed_at_once) {
  for (int undefined_at = 1; undefined_at <= 3; ++undefined_at) {
    Stepper stepper(Method::dop853, 1);
    const double x = 1.0;
    const double slope = -1.0;
    ASSERT_EQ(stepper.attempt([](double, const double* y, double* ydot) { *ydot = -*y; }, 0.0, &x, &slope, 0.1, {}),
              Attempt::finite);
    int calls = 0;
    const auto f = [&](double, const double* y, double* ydot) {
      *ydot = ++calls == undefined_at ? std::log(-1.0) : -*y;
    };
    DenseStep dense;
    EXPECT_EQ(stepper.dense(f, dense), Attempt::undefined);
    EXPECT_EQ(calls, undefined_at);
  }
}

}  // namespace
}  // namespace saltus::ode
