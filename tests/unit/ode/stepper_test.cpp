#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

class EachMethod : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Stepper, EachMethod, ::testing::ValuesIn(all_methods));
class ExplicitMethod : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Stepper, ExplicitMethod, ::testing::ValuesIn(explicit_methods));

// x' = cos t (1 + x^2), x = tan sin t.
double nonlinear_error(Method method, int steps) {
  const auto f = [](double t, const double* x, double* xdot) { *xdot = std::cos(t) * (1.0 + *x * *x); };
  return std::abs(fixed_steps(method, f, {0.0}, 0.0, 2.0, steps)[0] - std::tan(std::sin(2.0)));
}

TEST_P(EachMethod, error_falls_with_the_order) {
  // From where the leading term dominates to where rounding is still a hundredth of the error.
  const int coarse = order(GetParam()) == 5 ? 32 : order(GetParam()) == 13 ? 3 : 6;
  for (const int steps : order(GetParam()) > 8 ? std::vector{coarse} : std::vector{coarse, 2 * coarse}) {
    const double error = nonlinear_error(GetParam(), steps);
    const double finer = nonlinear_error(GetParam(), 2 * steps);
    EXPECT_NEAR(std::log2(error / finer), order(GetParam()), order(GetParam()) == 13 ? 1.0 : 0.5)
        << "errors " << error << ", " << finer;
  }
}

// x' = d t^(d-1) from t = 1/2, so x = t^d, in one step of length 1.
double end_error_of_power(Method method, int degree) {
  const auto f = [&](double t, const double*, double* xdot) { *xdot = degree * std::pow(t, degree - 1); };
  const auto x = fixed_steps(method, f, {std::pow(0.5, degree)}, 0.5, 1.5, 1);
  return std::abs(x[0] - std::pow(1.5, degree)) / std::pow(1.5, degree);
}

TEST_P(EachMethod, integrates_powers_up_to_its_order_exactly_and_no_further) {
  // DOP853's weights are up to 6 in size.
  for (int degree = 1; degree <= order(GetParam()); ++degree)
    EXPECT_LT(end_error_of_power(GetParam(), degree), 40 * epsilon);
  EXPECT_GT(end_error_of_power(GetParam(), order(GetParam()) + 1), 1e-10);
}

TEST_P(ExplicitMethod, arenstorf_orbit_closes) {
  // Hairer, Norsett & Wanner, II.0: three bodies; the orbit's period and start.
  const auto f = [](double, const double* x, double* xdot) {
    constexpr double mu = 0.012277471;
    constexpr double rest = 1.0 - mu;
    const double d1 = std::pow((x[0] + mu) * (x[0] + mu) + x[1] * x[1], 1.5);
    const double d2 = std::pow((x[0] - rest) * (x[0] - rest) + x[1] * x[1], 1.5);
    xdot[0] = x[2];
    xdot[1] = x[3];
    xdot[2] = x[0] + 2.0 * x[3] - rest * (x[0] + mu) / d1 - mu * (x[0] - rest) / d2;
    xdot[3] = x[1] - 2.0 * x[2] - rest * x[1] / d1 - mu * x[1] / d2;
  };
  const std::vector<double> start{0.994, 0.0, 0.0, -2.00158510637908252240537862224};
  const double period = 17.0652165601579625588917206249;
  const Trajectory loose = controlled_steps(GetParam(), f, start, 0.0, period, {.rtol = 1e-9, .atol = 1e-9});
  const Trajectory tight = controlled_steps(GetParam(), f, start, 0.0, period, {.rtol = 1e-12, .atol = 1e-12});
  // Errors of the first close approach arrive amplified by about 1e5 at the end.
  EXPECT_LT(distance(loose.x.data(), start), 1e-2);
  EXPECT_LT(distance(tight.x.data(), start), 1e-5);
  EXPECT_LT(tight.accepted, GetParam() == Method::dopri5 ? 2500 : 400);
  EXPECT_LT(tight.rejected, tight.accepted / 4);
}

TEST_P(ExplicitMethod, error_norm_estimates_a_higher_power_of_the_step) {
  const auto x = Kepler::exact(0.5);
  std::vector<double> slope(x.size());
  Kepler{}(0.5, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  const Tolerances tolerances{.rtol = 1e-9, .atol = 1e-9};
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.1, tolerances), Attempt::finite);
  const double coarse = stepper.error_norm();
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.05, tolerances), Attempt::finite);
  // dopri5: local error of order 4; dop853: order 5 of one estimate squared over order 3 of the other, 2 * 6 - 4 = 8.
  EXPECT_NEAR(std::log2(coarse / stepper.error_norm()), order(GetParam()), 0.5);
  // What is estimated is there: at least as large as the true error, and not lost in rounding.
  EXPECT_GT(stepper.error_norm() * 2e-9, distance(stepper.x_new(), Kepler::exact(0.55)));
}

TEST_P(ExplicitMethod, last_slope_and_number_of_evaluations) {
  int calls = 0;
  const auto f = [&](double t, const double* x, double* xdot) {
    ++calls;
    Kepler{}(t, x, xdot);
  };
  const auto x = Kepler::exact(0.0);
  std::vector<double> slope(x.size());
  Kepler{}(0.0, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  ASSERT_EQ(stepper.attempt(f, 0.0, x.data(), slope.data(), 0.1, {}), Attempt::finite);
  EXPECT_EQ(calls, GetParam() == Method::dopri5 ? 6 : 12);
  std::vector<double> expected(x.size());
  Kepler{}(0.1, stepper.x_new(), expected.data());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(stepper.slope_new()[i], expected[i]);
  DenseStep dense;
  ASSERT_EQ(stepper.dense(f, dense), Attempt::finite);
  EXPECT_EQ(calls, GetParam() == Method::dopri5 ? 6 : 15);
  EXPECT_EQ(stepper.evaluations(), calls);
}

TEST_P(EachMethod, continues_from_its_own_result) {
  auto x = Kepler::exact(0.0);
  std::vector<double> slope(x.size());
  Kepler{}(0.0, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  stepper.attempt(Kepler{}, 0.0, x.data(), slope.data(), 0.1, {});
  stepper.attempt(Kepler{}, 0.1, stepper.x_new(), stepper.slope_new(), 0.1, {});
  const auto expected = fixed_steps(GetParam(), Kepler{}, x, 0.0, 0.2, 2);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(stepper.x_new()[i], expected[i]);
}

// Of n uncoupled equations: everything a step says of the first one.
std::vector<double> first_of(Method method, std::size_t n) {
  const auto f = [n](double t, const double* x, double* xdot) {
    for (std::size_t i = 0; i < n; ++i) xdot[i] = std::cos(t + static_cast<double>(i)) * (1.0 + x[i] * x[i]);
  };
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = 0.1 / (1.0 + static_cast<double>(i));
  std::vector<double> slope(n), low(n), high(n), inside(n);
  f(0.2, x.data(), slope.data());
  Stepper stepper(method, static_cast<int>(n));
  DenseStep dense;
  EXPECT_EQ(stepper.attempt(f, 0.2, x.data(), slope.data(), 0.3, {}), Attempt::finite);
  EXPECT_TRUE(stepper.bounds(low.data(), high.data()));
  EXPECT_EQ(stepper.dense(f, dense), Attempt::finite);
  dense.evaluate(0.3, inside.data());
  return {stepper.x_new()[0], stepper.slope_new()[0], low[0], high[0], inside[0]};
}

TEST_P(ExplicitMethod, a_component_has_the_same_bits_among_any_number_of_others) {
  // 1 to 8 states have functions of their own.
  const auto alone = first_of(GetParam(), 1);
  for (std::size_t n = 2; n <= 10; ++n) EXPECT_EQ(first_of(GetParam(), n), alone) << n;
}

TEST_P(ExplicitMethod, stops_at_the_first_undefined_stage) {
  const int all = GetParam() == Method::dopri5 ? 6 : 12;
  for (int undefined_at = 1; undefined_at <= all; ++undefined_at) {
    int calls = 0;
    const auto f = [&](double, const double* x, double* xdot) {
      ++calls;
      xdot[0] = 1.0;
      xdot[1] = calls == undefined_at ? std::sqrt(-1.0 - x[0] * x[0]) : 0.0;
    };
    Stepper stepper(GetParam(), 2);
    const double x[] = {0.0, 0.0};
    const double slope[] = {1.0, 0.0};
    EXPECT_EQ(stepper.attempt(f, 0.0, x, slope, 0.1, {}), Attempt::undefined);
    EXPECT_EQ(calls, undefined_at);
    // The workspace holds a NaN now: nothing of it reaches the next attempt.
    calls = all;
    EXPECT_EQ(stepper.attempt(f, 0.0, x, slope, 0.1, {}), Attempt::finite);
    EXPECT_NEAR(stepper.x_new()[0], 0.1, 1e-15);
  }
}

TEST_P(EachMethod, undefined_slope_or_overflow_needs_no_further_evaluation) {
  int calls = 0;
  const auto f = [&](double, const double*, double* xdot) {
    ++calls;
    *xdot = 1e300;
  };
  Stepper stepper(GetParam(), 1);
  const double x = 1e308;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &undefined, 0.1, {}), Attempt::undefined);
  EXPECT_EQ(calls, 0);
  const double slope = 1e300;
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &slope, 1e10, {}), Attempt::undefined);
  EXPECT_EQ(calls, 0);
}

TEST_P(EachMethod, huge_errors_are_rejected_whatever_overflows) {
  const auto f = [](double t, const double*, double* xdot) { *xdot = t == 0.0 ? 1e250 : -1e250; };
  Stepper stepper(GetParam(), 1);
  const double x = 0.0;
  const double slope = 1e250;
  ASSERT_EQ(stepper.attempt(f, 0.0, &x, &slope, 1.0, {.rtol = 0.0, .atol = 1e-10}), Attempt::finite);
  EXPECT_GT(stepper.error_norm(), 1e100);
}

TEST_P(EachMethod, zero_state_without_absolute_tolerance_has_no_error_if_it_stays_zero) {
  const auto f = [](double, const double* x, double* xdot) {
    xdot[0] = 0.0;
    xdot[1] = -x[1];
  };
  Stepper stepper(GetParam(), 2);
  const double x[] = {0.0, 1.0};
  const double slope[] = {0.0, -1.0};
  ASSERT_EQ(stepper.attempt(f, 0.0, x, slope, 0.1, {.rtol = 1e-6, .atol = 0.0}), Attempt::finite);
  EXPECT_LT(stepper.error_norm(), 1.0);
  EXPECT_EQ(stepper.x_new()[0], 0.0);
}

TEST_P(EachMethod, powers_of_two_scale_exactly) {
  // Pendulum with x in units of 2^-20 and t in units of 2^9.
  const double unit = 0x1p-20;
  const double time = 0x1p9;
  const auto plain = [](double t, const double* x, double* xdot) {
    xdot[0] = x[1];
    xdot[1] = -x[0] * x[0] * x[0] + t;
  };
  const auto scaled = [&](double t, const double* x, double* xdot) {
    const double in[] = {x[0] / unit, x[1] / unit};
    plain(t / time, in, xdot);
    for (int i : {0, 1}) xdot[i] *= unit / time;
  };
  const auto end = [&](RightHandSide f, double x_unit, double t_unit) {
    return controlled_steps(GetParam(), f, {0.7 * x_unit, 0.1 * x_unit}, 0.0, 3.0 * t_unit,
                            {.rtol = 1e-7, .atol = 1e-9 * x_unit});
  };
  const Trajectory first = end(plain, 1.0, 1.0);
  const Trajectory second = end(scaled, unit, time);
  EXPECT_GT(first.accepted, 5);
  EXPECT_EQ(first.accepted, second.accepted);
  for (std::size_t i : {0U, 1U}) EXPECT_EQ(first.x[i] * unit, second.x[i]);
}

TEST_P(EachMethod, runs_backwards) {
  const auto x = Kepler::exact(2.0);
  const Trajectory run = controlled_steps(GetParam(), Kepler{}, x, 2.0, 0.0, {.rtol = 1e-10, .atol = 1e-10});
  EXPECT_LT(distance(run.x.data(), Kepler::exact(0.0)), 1e-8);
}

TEST_P(EachMethod, no_states_are_fine) {
  const auto f = [](double, const double*, double*) {};
  Stepper stepper(GetParam(), 0);
  EXPECT_EQ(stepper.attempt(f, 0.0, nullptr, nullptr, 0.1, {}), Attempt::finite);
  EXPECT_EQ(stepper.error_norm(), 0.0);
}

}  // namespace
}  // namespace saltus::ode
