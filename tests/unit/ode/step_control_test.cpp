#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

struct Limits {
  double smallest;
  double largest;
};
Limits limits(Method method) {
  if (is_implicit(method)) return {0.2, 8.0};
  return method == Method::dopri5 ? Limits{0.2, 10.0} : Limits{0.333, 6.0};
}

class Control : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(StepControl, Control, ::testing::ValuesIn(all_methods));

TEST_P(Control, factors_stay_within_their_limits) {
  EXPECT_EQ(StepControl(GetParam()).accepted(0.0), limits(GetParam()).largest);
  EXPECT_EQ(StepControl(GetParam()).accepted(1e-300), limits(GetParam()).largest);
  EXPECT_EQ(StepControl(GetParam()).rejected(1e300), limits(GetParam()).smallest);
  EXPECT_EQ(StepControl(GetParam()).rejected(infinity), limits(GetParam()).smallest);
  EXPECT_LE(StepControl(GetParam()).rejected(1.0 + 1e-15), 0.9);
}

TEST_P(Control, no_increase_right_after_a_rejection) {
  StepControl control(GetParam());
  EXPECT_LT(control.rejected(10.0), 1.0);
  EXPECT_LT(control.rejected(2.0), 1.0);
  EXPECT_EQ(control.accepted(1e-6), 1.0);
  EXPECT_GT(control.accepted(1e-6), 1.0);
}

TEST_P(Control, goes_on_behind_an_event_as_in_a_row_of_like_steps) {
  for (const double error : {1e-6, 1e-4, 1e-2, 0.3, 1.0}) {
    StepControl row(GetParam());
    static_cast<void>(row.accepted(error));
    StepControl behind(GetParam());
    static_cast<void>(behind.accepted(1e-3));
    behind.restart();
    EXPECT_EQ(behind.accepted(error), row.accepted(error)) << error;
    // From there on both have the same past.
    EXPECT_EQ(behind.accepted(0.2), row.accepted(0.2)) << error;
  }
}

TEST_P(Control, larger_errors_give_smaller_factors) {
  double previous = infinity;
  for (double error = 1e-8; error <= 1.0; error *= 1.7) {
    const double factor = StepControl(GetParam()).accepted(error);
    EXPECT_LE(factor, previous);
    previous = factor;
  }
  previous = 1.0;
  for (double error = 1.001; error < 1e8; error *= 1.7) {
    const double factor = StepControl(GetParam()).rejected(error);
    EXPECT_LE(factor, previous);
    previous = factor;
  }
}

TEST_P(Control, reset_forgets_everything) {
  StepControl used(GetParam());
  static_cast<void>(used.accepted(0.9));
  static_cast<void>(used.rejected(5.0));
  used.reset();
  EXPECT_EQ(used.accepted(0.3), StepControl(GetParam()).accepted(0.3));
}

TEST(StepControl, dopri5_remembers_the_last_error_and_dop853_does_not) {
  StepControl pi(Method::dopri5);
  static_cast<void>(pi.accepted(0.5));
  // 0.9 e^-(1/5 - 3/4 beta) e_last^beta, beta = 0.04
  EXPECT_NEAR(pi.accepted(0.1), 0.9 * std::pow(0.1, -0.17) * std::pow(0.5, 0.04), 1e-14);
  StepControl plain(Method::dop853);
  static_cast<void>(plain.accepted(0.5));
  EXPECT_NEAR(plain.accepted(0.1), 0.9 * std::pow(0.1, -0.125), 1e-14);
}

TEST(StepControl, dop853_foresees_growing_errors_behind_a_rejection) {
  // The error of steps of length 1 grows fourfold from one to the next: 256^(1/8) = 2 would be its step ratio.
  const auto error = [](double length, int step) { return std::pow(length, 8) * std::pow(4.0, step) * 0.01; };
  StepControl control(Method::dop853);
  double h = control.rejected(error(2.0, 0)) * 2.0;
  h *= control.accepted(error(h, 0));
  int rejections = 0;
  for (int step = 1; step < 30; ++step) {
    if (error(h, step) > 1.0) {
      ++rejections;
      h *= control.rejected(error(h, step));
    }
    ASSERT_LE(error(h, step), 1.0);
    ASSERT_GE(error(h, step), 0.1) << "steps are not shorter than they need be";
    h *= control.accepted(error(h, step));
  }
  EXPECT_LE(rejections, 1);
}

TEST(StepControl, dop853_takes_falling_errors_for_no_reason_to_grow_more) {
  StepControl control(Method::dop853);
  static_cast<void>(control.rejected(2.0));
  static_cast<void>(control.accepted(0.9));
  EXPECT_NEAR(control.accepted(0.1), 0.9 * std::pow(0.1, -0.125), 1e-14);
}

double first_step(Method method, RightHandSide f, std::vector<double> x, double span, const Tolerances& tolerances) {
  std::vector<double> slope(x.size());
  f(0.0, x.data(), slope.data());
  return initial_step(method, f, 0.0, x.data(), slope.data(), static_cast<int>(x.size()), span, tolerances);
}

TEST_P(Control, first_step_is_accepted_and_not_wasteful) {
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Tolerances tolerances{.rtol = tolerance, .atol = tolerance};
    const auto x = Kepler::exact(0.0);
    std::vector<double> slope(x.size());
    Kepler{}(0.0, x.data(), slope.data());
    const double h = first_step(GetParam(), Kepler{}, x, 10.0, tolerances);
    Stepper stepper(GetParam(), Kepler::n);
    ASSERT_EQ(stepper.attempt(Kepler{}, 0.0, x.data(), slope.data(), h, tolerances), Attempt::finite);
    EXPECT_LT(stepper.error_norm(), 1.0) << "step " << h;
    const Attempt longer = stepper.attempt(Kepler{}, 0.0, x.data(), slope.data(), 100.0 * h, tolerances);
    EXPECT_TRUE(longer == Attempt::undefined || stepper.error_norm() > 1.0) << "step " << h;
  }
}

TEST_P(Control, first_step_has_the_direction_of_the_span_and_stays_within) {
  EXPECT_LT(first_step(GetParam(), Kepler{}, Kepler::exact(0.0), -5.0, {}), 0.0);
  EXPECT_EQ(first_step(GetParam(), Kepler{}, Kepler::exact(0.0), -1e-9, {}), -1e-9);
  EXPECT_EQ(first_step(GetParam(), Kepler{}, Kepler::exact(0.0), 1e-9, {}), 1e-9);
}

TEST_P(Control, first_step_from_rest_is_a_fraction_of_the_span) {
  const auto nothing = [](double, const double*, double* xdot) { xdot[0] = 0.0; };
  const auto constant = [](double, const double*, double* xdot) { xdot[0] = 1.0; };
  const auto force = [](double t, const double*, double* xdot) { xdot[0] = t; };
  for (const double span : {1e-6, 1.0, 1e6}) {
    for (const RightHandSide f : {RightHandSide(nothing), RightHandSide(constant), RightHandSide(force)}) {
      for (const double x : {0.0, 1.0}) {
        const double h = first_step(GetParam(), f, {x}, span, {});
        EXPECT_GT(h, 1e-9 * span);
        EXPECT_LE(h, span);
      }
    }
  }
}

TEST_P(Control, straight_lines_take_a_handful_of_steps) {
  const auto f = [](double, const double*, double* xdot) { xdot[0] = 3.0; };
  for (const double x : {-1.0, 0.0, 1e-17}) {
    EXPECT_LE(controlled_steps(GetParam(), f, {x}, 0.0, 0.7, {.rtol = 1e-12, .atol = 1e-14}).accepted, 6);
  }
}

TEST_P(Control, first_step_scales_with_time_and_state) {
  const auto plain = [](double t, const double* x, double* xdot) { xdot[0] = -x[0] * x[0] + std::cos(t); };
  const double expected = first_step(GetParam(), plain, {2.0}, 7.0, {.rtol = 1e-8, .atol = 1e-9});
  for (const double time : {1.0, 0x1p20, 0x1p-20}) {
    for (const double unit : {1.0, 0x1p30, 0x1p-30}) {
      const auto scaled = [&](double t, const double* x, double* xdot) {
        const double in = *x / unit;
        plain(t / time, &in, xdot);
        *xdot *= unit / time;
      };
      EXPECT_EQ(first_step(GetParam(), scaled, {2.0 * unit}, 7.0 * time, {.rtol = 1e-8, .atol = 1e-9 * unit}),
                expected * time);
    }
  }
  const auto slow = [&](double t, const double* x, double* xdot) {
    plain(t / 1e5, x, xdot);
    *xdot /= 1e5;
  };
  EXPECT_NEAR(first_step(GetParam(), slow, {2.0}, 7e5, {.rtol = 1e-8, .atol = 1e-9}) / 1e5, expected, 1e-12 * expected);
}

TEST_P(Control, first_step_shortens_where_the_right_hand_side_is_undefined) {
  // Defined up to x = 2e-5 only; the first Euler step ends at 1e-4 of the span.
  int calls = 0;
  const auto f = [&](double, const double* x, double* xdot) {
    ++calls;
    xdot[0] = x[0] > 2e-5 ? std::sqrt(-x[0]) : 1.0;
  };
  const double h = first_step(GetParam(), f, {0.0}, 1.0, {});
  EXPECT_GT(h, 1e-7);
  EXPECT_LT(h, 2e-5);
  EXPECT_EQ(calls, 3);
  // Undefined everywhere: some step, but not 0 and not NaN.
  const auto nowhere = [](double t, const double*, double* xdot) { xdot[0] = t == 0.0 ? 1.0 : std::sqrt(-1.0); };
  const double tiny = first_step(GetParam(), nowhere, {1.0}, 1.0, {});
  EXPECT_GT(tiny, 0.0);
  EXPECT_LT(tiny, 1e-6);
}

TEST_P(Control, first_step_survives_overflow) {
  const auto f = [](double, const double* x, double* xdot) { xdot[0] = 1e250 * x[0]; };
  const double h = first_step(GetParam(), f, {1.0}, 1.0, {});
  EXPECT_GT(h, 0.0);
  EXPECT_LT(h, 1e-200);
}

TEST(StepControl, costs_one_evaluation) {
  int calls = 0;
  const auto f = [&](double, const double* x, double* xdot) {
    ++calls;
    xdot[0] = -x[0];
  };
  static_cast<void>(first_step(Method::dopri5, f, {1.0}, 1.0, {}));
  EXPECT_EQ(calls, 2);  // one of them made the slope
}

}  // namespace
}  // namespace saltus::ode
