#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"
#include "saltus/ode/radau5_tableau.hpp"

namespace saltus::ode {
namespace {

using namespace trial;
using Tableau = Radau5Tableau;

/// Integral of the j-th Lagrange polynomial of the nodes from 0 to their i-th node.
double weight(std::size_t i, std::size_t j) {
  const double a = Tableau::c[(j + 1) % 3];
  const double b = Tableau::c[(j + 2) % 3];
  const double own = Tableau::c[j];
  const double x = Tableau::c[i];
  return (x * x * x / 3.0 - (a + b) * x * x / 2.0 + a * b * x) / ((own - a) * (own - b));
}

TEST(Radau5Tableau, nodes_make_the_quadrature_exact_to_degree_four) {
  for (int degree = 0; degree <= 4; ++degree) {
    double sum = 0.0;
    for (std::size_t j = 0; j < 3; ++j) sum += weight(2, j) * std::pow(Tableau::c[j], degree);
    EXPECT_NEAR(sum, 1.0 / (degree + 1), 4 * epsilon);
  }
}

// inverse(A) t = t L is t = A t L.
TEST(Radau5Tableau, transformation_splits_the_coefficient_matrix) {
  constexpr double alpha = Tableau::alpha;
  constexpr double beta = Tableau::beta;
  const double blocks[3][3] = {{Tableau::gamma, 0.0, 0.0}, {0.0, alpha, -beta}, {0.0, beta, alpha}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double product = 0.0;
      double identity = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        identity += Tableau::t[i][k] * Tableau::t_inverse[k][j];
        for (std::size_t l = 0; l < 3; ++l) product += weight(i, k) * Tableau::t[k][l] * blocks[l][j];
      }
      EXPECT_NEAR(product, Tableau::t[i][j], 8 * epsilon);
      EXPECT_NEAR(identity, i == j ? 1.0 : 0.0, 8 * epsilon);
    }
  }
}

// The estimate vanishes for slopes that are polynomials of degree 2: gamma0 f(0) + sum e_j z_j = 0 with z_j the
// integral of f over c_j, so it is of order 3.
TEST(Radau5Tableau, error_estimate_has_order_three) {
  for (int degree = 0; degree <= 3; ++degree) {
    double sum = degree == 0 ? 1.0 : 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      sum += Tableau::error[j] * std::pow(Tableau::c[j], degree + 1) / (degree + 1);
    }
    if (degree < 3) {
      EXPECT_NEAR(sum, 0.0, 16 * epsilon) << degree;
    } else {
      EXPECT_GT(std::abs(sum), 1e-3);
    }
  }
}

TEST(Radau5, error_estimate_falls_with_the_fourth_power_of_the_step) {
  const auto x = Kepler::exact(0.5);
  std::vector<double> slope(x.size());
  Kepler{}(0.5, x.data(), slope.data());
  Stepper stepper(Method::radau5, Kepler::n);
  const Tolerances tolerances{.rtol = 1e-6, .atol = 1e-6};
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.02, tolerances), Attempt::finite);
  const double coarse = stepper.error_norm();
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.01, tolerances), Attempt::finite);
  EXPECT_NEAR(std::log2(coarse / stepper.error_norm()), 4.0, 0.5);
  EXPECT_GT(stepper.error_norm() * 2e-6, distance(stepper.x_new(), Kepler::exact(0.51)));
}

TEST(Radau5, last_slope_belongs_to_the_new_point) {
  const auto x = Kepler::exact(0.5);
  std::vector<double> slope(x.size());
  Kepler{}(0.5, x.data(), slope.data());
  Stepper stepper(Method::radau5, Kepler::n);
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.1, {}), Attempt::finite);
  std::vector<double> expected(x.size());
  Kepler{}(0.6, stepper.x_new(), expected.data());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(stepper.slope_new()[i], expected[i]);
}

// x >= t, and x = 2 t: where stages begin at x(t) they are outside.
TEST(Radau5, a_domain_that_moves_with_time_is_not_left) {
  const auto field = [](double t, const double* x, double* f) { f[0] = x[0] < t ? std::nan("") : 2.0; };
  const double x = 0.0, slope = 2.0;
  Stepper stepper(Method::radau5, 1);
  for (const double h : {0.5, 1e-9}) {
    ASSERT_EQ(stepper.attempt(field, 0.0, &x, &slope, h, {}), Attempt::finite) << h;
    EXPECT_NEAR(stepper.x_new()[0], 2.0 * h, 4 * epsilon * h);
  }
}

// x' = -L (x - cos t) - sin t: x = cos t is reached at once and followed, whatever L.
TEST(Radau5, stiff_linear_problem_takes_steps_of_the_smooth_solution) {
  int steps[2];
  for (const int k : {0, 1}) {
    const double rate = k == 0 ? 1e4 : 1e8;
    const auto f = [&](double t, const double* x, double* xdot) { *xdot = -rate * (*x - std::cos(t)) - std::sin(t); };
    const Trajectory run = controlled_steps(Method::radau5, f, {1.5}, 0.0, 10.0, {.rtol = 1e-7, .atol = 1e-7});
    EXPECT_NEAR(run.x[0], std::cos(10.0), 1e-7) << rate;
    steps[k] = run.accepted + run.rejected;
  }
  EXPECT_LT(steps[0], 300);
  EXPECT_LT(steps[1], 200);
}

// L-stable: a perturbation is gone after one step that is long against its time.
TEST(Radau5, damps_stiff_components_in_one_step) {
  const auto f = [](double t, const double* x, double* xdot) { *xdot = -1e8 * (*x - std::cos(t)) - std::sin(t); };
  EXPECT_NEAR(fixed_steps(Method::radau5, f, {2.0}, 0.0, 0.1, 1)[0], std::cos(0.1), 1e-5);
}

/// Van der Pol in the scaling of Hairer & Wanner, IV.10: 1 / mu^2 = 1e-6.
struct VanDerPol {
  void operator()(double /*t*/, const double* x, double* xdot) const {
    xdot[0] = x[1];
    xdot[1] = ((1.0 - x[0] * x[0]) * x[1] - x[0]) / 1e-6;
  }
};

TEST(Radau5, van_der_pol) {
  // Values at t = 2 from the Test Set for IVP Solvers (vdpol). The two jumps amplify local errors.
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const Tolerances tolerances{.rtol = tolerance, .atol = tolerance};
    const Trajectory run = controlled_steps(Method::radau5, VanDerPol{}, {2.0, 0.0}, 0.0, 2.0, tolerances);
    EXPECT_NEAR(run.x[0], 0.1706167732170483e1, 50 * tolerance);
    EXPECT_NEAR(run.x[1], -0.8928097010247975, 50 * tolerance);
    EXPECT_LT(run.rejected, run.accepted / 4);
  }
}

TEST(Radau5, order_five_on_the_stiff_smooth_part_of_van_der_pol) {
  // From the first segment, where the solution is smooth; the reference is the same method with much shorter steps.
  const auto start =
      controlled_steps(Method::radau5, VanDerPol{}, {2.0, -0.66}, 0.0, 0.3, {.rtol = 1e-13, .atol = 1e-13});
  const auto reference = fixed_steps(Method::radau5, VanDerPol{}, start.x, 0.3, 0.7, 128);
  const auto error = [&](int steps) {
    return std::abs(fixed_steps(Method::radau5, VanDerPol{}, start.x, 0.3, 0.7, steps)[0] - reference[0]);
  };
  EXPECT_GT(std::log2(error(4) / error(8)), 4.5);
  EXPECT_GT(std::log2(error(8) / error(16)), 4.5);
}

TEST(Radau5, robertson) {
  const auto f = [](double, const double* x, double* xdot) {
    xdot[0] = -0.04 * x[0] + 1e4 * x[1] * x[2];
    xdot[2] = 3e7 * x[1] * x[1];
    xdot[1] = -xdot[0] - xdot[2];
  };
  const Trajectory run = controlled_steps(Method::radau5, f, {1.0, 0.0, 0.0}, 0.0, 1e11, {.rtol = 1e-9, .atol = 1e-15});
  // Hairer & Wanner, test set of IV.10, t = 1e11.
  EXPECT_NEAR(run.x[0], 0.2083340149701255e-7, 1e-13);
  EXPECT_NEAR(run.x[1], 0.8333360770334713e-13, 1e-18);
  EXPECT_NEAR(run.x[2], 0.9999999791665050, 1e-9);
  EXPECT_LT(run.accepted + run.rejected, 4000);
}

TEST(Radau5, a_retaken_step_depends_on_nothing_but_its_length) {
  const auto start = fixed_steps(Method::radau5, VanDerPol{}, {2.0, -0.66}, 0.0, 0.1, 200);
  std::vector<double> slope(2);
  VanDerPol{}(0.1, start.data(), slope.data());
  const auto retaken = [&](double detour) {
    Stepper stepper(Method::radau5, 2);
    for (const double h : {0.02, detour, 0.013}) {
      EXPECT_EQ(stepper.attempt(VanDerPol{}, 0.1, start.data(), slope.data(), h, {}), Attempt::finite);
    }
    return std::vector<double>(stepper.x_new(), stepper.x_new() + 2);
  };
  EXPECT_EQ(retaken(0.01), retaken(0.002));
}

TEST(Radau5, ends_of_retaken_steps_lie_on_one_smooth_curve) {
  const auto x = Kepler::exact(0.2);
  std::vector<double> slope(x.size());
  Kepler{}(0.2, x.data(), slope.data());
  Stepper stepper(Method::radau5, Kepler::n);
  const auto end = [&](double h) {
    EXPECT_EQ(stepper.attempt(Kepler{}, 0.2, x.data(), slope.data(), h, {}), Attempt::finite);
    return stepper.x_new()[0];
  };
  // Second differences over 2^-30 are rounding, and nothing but rounding.
  for (int k = 0; k < 100; ++k) {
    const double h = 0.2 + 0.001 * k;
    const double bend = end(h + 0x1p-30) - 2.0 * end(h) + end(h - 0x1p-30);
    EXPECT_LT(std::abs(bend), 16 * epsilon) << h;
  }
}

TEST(Radau5, restart_forgets_the_steps_before) {
  const auto x = Kepler::exact(0.0);
  std::vector<double> slope(x.size());
  const auto other = [](double, const double* y, double* ydot) {
    for (int i = 0; i < Kepler::n; ++i) ydot[i] = -1e3 * y[i];
  };
  const auto step = [&](Stepper& stepper) {
    Kepler{}(0.0, x.data(), slope.data());
    EXPECT_EQ(stepper.attempt(Kepler{}, 0.0, x.data(), slope.data(), 0.1, {}), Attempt::finite);
    return std::vector<double>(stepper.x_new(), stepper.x_new() + x.size());
  };
  Stepper fresh(Method::radau5, Kepler::n);
  Stepper used(Method::radau5, Kepler::n);
  other(0.0, x.data(), slope.data());
  ASSERT_EQ(used.attempt(other, 0.0, x.data(), slope.data(), 0.1, {}), Attempt::finite);
  used.restart();
  EXPECT_EQ(step(used), step(fresh));
}

TEST(Radau5, keeps_the_jacobian_of_a_linear_problem) {
  constexpr int n = 20;
  const auto f = [](double, const double* x, double* xdot) {
    for (int i = 0; i < n; ++i) xdot[i] = -(i + 1.0) * x[i];
  };
  const int steps = 50;
  Stepper stepper(Method::radau5, n);
  std::vector<double> x(n, 1.0), slope(n);
  f(0.0, x.data(), slope.data());
  for (int k = 0; k < steps; ++k) {
    ASSERT_EQ(stepper.attempt(f, 0.01 * k, x.data(), slope.data(), 0.01, {.rtol = 1e-3, .atol = 1e-3}),
              Attempt::finite);
    std::copy_n(stepper.x_new(), n, x.begin());
    std::copy_n(stepper.slope_new(), n, slope.begin());
  }
  // One Jacobian, and three or four iterations of three stages a step: not n evaluations a step.
  EXPECT_LT(stepper.evaluations(), n + steps * 13);
  EXPECT_NEAR(x[0], std::exp(-0.5), 1e-12);
}

TEST(Radau5, undefined_right_hand_sides_shorten_the_step) {
  // Defined to x = 1 only.
  const auto f = [](double, const double* x, double* xdot) { *xdot = 1.0 + std::sqrt(1.0 - *x); };
  Stepper stepper(Method::radau5, 1);
  const double x = 0.0;
  const double slope = 2.0;
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &slope, 2.0, {}), Attempt::undefined);
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &slope, 0.1, {}), Attempt::finite);
  const double again = *stepper.x_new();
  Stepper fresh(Method::radau5, 1);
  ASSERT_EQ(fresh.attempt(f, 0.0, &x, &slope, 0.1, {}), Attempt::finite);
  EXPECT_EQ(again, *fresh.x_new());
}

TEST(Radau5, starts_at_the_edge_of_its_domain) {
  // x' = sqrt(x) + 1 from 0: the Jacobian is differenced into the domain.
  const auto f = [](double, const double* x, double* xdot) { *xdot = std::sqrt(*x) + 1.0; };
  const Trajectory run = controlled_steps(Method::radau5, f, {0.0}, 0.0, 1.0, {.rtol = 1e-8, .atol = 1e-8});
  // 2 (u - log(1 + u)) = t with u = sqrt(x)
  const double u = std::sqrt(run.x[0]);
  EXPECT_NEAR(2.0 * (u - std::log1p(u)), 1.0, 1e-6);
}

int stiff_after(Method method, RightHandSide f, std::vector<double> x, int steps, double h) {
  Stepper stepper(method, static_cast<int>(x.size()));
  StiffnessWatch watch;
  std::vector<double> slope(x.size());
  f(0.0, x.data(), slope.data());
  for (int k = 0; k < steps; ++k) {
    stepper.attempt(f, k * h, x.data(), slope.data(), h, {});
    std::copy_n(stepper.x_new(), x.size(), x.begin());
    std::copy_n(stepper.slope_new(), x.size(), slope.begin());
    if (watch.looks_stiff(stepper)) return k;
  }
  return -1;
}

TEST(StiffnessWatch, tells_stability_from_accuracy) {
  for (const Method method : explicit_methods) {
    const double limit = method == Method::dopri5 ? 3.25 : 6.1;
    const auto f = [](double t, const double* x, double* xdot) {
      xdot[0] = -1000.0 * (x[0] - std::cos(t));
      xdot[1] = -x[1];
    };
    // 16 steps to the first look, 15 suspicions from then on.
    EXPECT_EQ(stiff_after(method, f, {1.0, 1.0}, 100, 1.01 * limit / 1000.0), 29);
    EXPECT_EQ(stiff_after(method, f, {1.0, 1.0}, 100, 0.9 * limit / 1000.0), -1);
  }
  EXPECT_EQ(stiff_after(Method::radau5, VanDerPol{}, {2.0, -0.66}, 100, 1e-3), -1);
}

}  // namespace
}  // namespace saltus::ode
