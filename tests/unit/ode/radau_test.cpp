#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "ode_tools.hpp"
#include "saltus/ode/radau_tableau.hpp"

namespace saltus::ode {
namespace {

using namespace trial;
/// Integral of the j-th Lagrange polynomial of the nodes from 0 to their i-th node, by Gauss's quadrature.
template <class Tableau>
double weight(std::size_t i, std::size_t j) {
  constexpr auto& c = Tableau::c;
  constexpr double nodes[] = {0.18343464249564980494, 0.52553240991632898582, 0.79666647741362673959,
                              0.96028985649753623168};
  constexpr double weights[] = {0.36268378337836198297, 0.31370664587788728734, 0.22238103445337447054,
                                0.10122853629037625915};
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (const double node : {nodes[k], -nodes[k]}) {
      double product = 1.0;
      for (std::size_t l = 0; l < Tableau::stages; ++l) {
        if (l != j) product *= (0.5 * c[i] * (1.0 + node) - c[l]) / (c[j] - c[l]);
      }
      sum += 0.5 * c[i] * weights[k] * product;
    }
  }
  return sum;
}

template <class Tableau>
class RadauTableau : public ::testing::Test {};
using Tableaus = ::testing::Types<Radau5Tableau, Radau9Tableau, Radau13Tableau>;
TYPED_TEST_SUITE(RadauTableau, Tableaus);

TYPED_TEST(RadauTableau, NodesMakeTheQuadratureExactToTwiceTheStagesLessTwo) {
  constexpr auto stages = TypeParam::stages;
  const auto quadrature = [&](int degree) {
    double sum = 0.0;
    for (std::size_t j = 0; j < stages; ++j) {
      sum += weight<TypeParam>(stages - 1, j) * std::pow(TypeParam::c[j], degree);
    }
    return sum - 1.0 / (degree + 1);
  };
  const int exact = 2 * static_cast<int>(stages) - 2;
  for (int degree = 0; degree <= exact; ++degree) EXPECT_NEAR(quadrature(degree), 0.0, 16 * epsilon) << degree;
  EXPECT_GT(std::abs(quadrature(exact + 1)), 1e-9);
}

// inverse(A) t = t L is t = A t L.
TYPED_TEST(RadauTableau, TransformationSplitsTheCoefficientMatrix) {
  constexpr auto stages = TypeParam::stages;
  double blocks[stages][stages] = {};
  blocks[0][0] = TypeParam::gamma;
  for (std::size_t k = 0; k < stages / 2; ++k) {
    const auto [alpha, beta] = TypeParam::pairs[k];
    blocks[2 * k + 1][2 * k + 1] = blocks[2 * k + 2][2 * k + 2] = alpha;
    blocks[2 * k + 1][2 * k + 2] = -beta;
    blocks[2 * k + 2][2 * k + 1] = beta;
  }
  for (std::size_t i = 0; i < stages; ++i) {
    for (std::size_t j = 0; j < stages; ++j) {
      double product = 0.0, identity = 0.0, sizes = 0.0;
      for (std::size_t k = 0; k < stages; ++k) {
        const double term = TypeParam::t[i][k] * TypeParam::t_inverse[k][j];
        identity += term;
        sizes += std::abs(term);
        for (std::size_t l = 0; l < stages; ++l) product += weight<TypeParam>(i, k) * TypeParam::t[k][l] * blocks[l][j];
      }
      EXPECT_NEAR(product, TypeParam::t[i][j], 16 * epsilon);
      EXPECT_NEAR(identity, i == j ? 1.0 : 0.0, 8 * epsilon * std::max(1.0, sizes));
    }
  }
}

// The estimate vanishes for slopes that are polynomials of a degree below the number of stages: f(0) + sum e_j z_j = 0
// with z_j the integral of f over c_j.
TYPED_TEST(RadauTableau, ErrorEstimateHasTheOrderOfTheStages) {
  constexpr int stages = TypeParam::stages;
  for (int degree = 0; degree <= stages; ++degree) {
    double sum = degree == 0 ? 1.0 : 0.0;
    for (std::size_t j = 0; j < TypeParam::stages; ++j) {
      sum += TypeParam::error[j] * std::pow(TypeParam::c[j], degree + 1) / (degree + 1);
    }
    if (degree < stages) {
      EXPECT_NEAR(sum, 0.0, 64 * epsilon) << degree;
    } else {
      EXPECT_GT(std::abs(sum), 1e-5);
    }
  }
}

class EachRadauMethod : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, EachRadauMethod, ::testing::ValuesIn(radau_methods));

TEST_P(EachRadauMethod, ErrorEstimateFallsWithThePowerOfTheStages) {
  const auto x = Kepler::exact(0.5);
  std::vector<double> slope(x.size());
  Kepler{}(0.5, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  const Tolerances tolerances{.rtol = 1e-6, .atol = 1e-6};
  const double h = GetParam() == Method::radau5 ? 0.02 : 0.1;
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), h, tolerances), Attempt::finite);
  const double coarse = stepper.error_norm();
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), h / 2.0, tolerances), Attempt::finite);
  EXPECT_NEAR(std::log2(coarse / stepper.error_norm()), dense_degree(GetParam()) + 1, 0.5);
  EXPECT_GT(stepper.error_norm() * 2e-6, distance(stepper.x_new(), Kepler::exact(0.5 + h / 2.0)));
}

TEST_P(EachRadauMethod, LastSlopeBelongsToTheNewPoint) {
  const auto x = Kepler::exact(0.5);
  std::vector<double> slope(x.size());
  Kepler{}(0.5, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  ASSERT_EQ(stepper.attempt(Kepler{}, 0.5, x.data(), slope.data(), 0.1, {}), Attempt::finite);
  std::vector<double> expected(x.size());
  Kepler{}(0.6, stepper.x_new(), expected.data());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(stepper.slope_new()[i], expected[i]);
}

// x >= t, and x = 2 t: where stages begin at x(t) they are outside.
TEST_P(EachRadauMethod, ADomainThatMovesWithTimeIsNotLeft) {
  const auto field = [](double t, const double* x, double* f) { f[0] = x[0] < t ? std::nan("") : 2.0; };
  const double x = 0.0, slope = 2.0;
  Stepper stepper(GetParam(), 1);
  for (const double h : {0.5, 1e-9}) {
    ASSERT_EQ(stepper.attempt(field, 0.0, &x, &slope, h, {}), Attempt::finite) << h;
    EXPECT_NEAR(stepper.x_new()[0], 2.0 * h, 16 * rounding_growth(GetParam()) * epsilon * h);
  }
}

// Differences are undefined in both directions; where the derivatives are known, these serve.
TEST_P(EachRadauMethod, SaysThatItHasNoJacobian) {
  const auto field = [](double, const double* x, double* f) {
    f[0] = 0.0;
    f[1] = -x[1] + std::sqrt(x[0] - 1.0) + std::sqrt(1.0 - x[0]);
  };
  const auto derivatives = [](double, const double*, double* entries) {
    entries[0] = entries[1] = entries[2] = 0.0;
    entries[3] = -1.0;
    return true;
  };
  const JacobianFunction jacobian(derivatives);
  const double x[] = {1.0, 1.0}, slope[] = {0.0, -1.0};
  Stepper stepper(GetParam(), 2);
  for (const double h : {0.1, 1e-9}) {
    EXPECT_EQ(stepper.attempt(field, 0.0, x, slope, h, {}), Attempt::undefined);
    EXPECT_EQ(stepper.stages(), Stages::no_jacobian);
  }
  ASSERT_EQ(stepper.attempt(field, 0.0, x, slope, 0.1, {}, {.functions = {}, .jacobian = &jacobian}), Attempt::finite);
  EXPECT_EQ(stepper.stages(), Stages::found);
  EXPECT_NEAR(stepper.x_new()[1], std::exp(-0.1), 1e-7);
}

// gamma / h is an eigenvalue of the Jacobian, exactly: the increment of the difference is a power of two.
TEST_P(EachRadauMethod, SaysThatItsSystemsAreSingular) {
  constexpr double h = 0.125;
  const double gamma = GetParam() == Method::radau5   ? Radau5Tableau::gamma
                       : GetParam() == Method::radau9 ? Radau9Tableau::gamma
                                                      : Radau13Tableau::gamma;
  const auto field = [&](double, const double* x, double* f) {
    f[0] = gamma / h * x[0];
    f[1] = -x[1];
  };
  const double x[] = {0.0, 1.0}, slope[] = {0.0, -1.0};
  const Tolerances tolerances{0x1p-20, 0x1p-30};
  const JacobianPattern diagonal{.start = {0, 1, 2}, .row = {0, 1}};
  for (const JacobianPattern* pattern : {static_cast<const JacobianPattern*>(nullptr), &diagonal}) {
    Stepper stepper(GetParam(), 2);
    RightHandSideStages stages;
    stages.pattern = pattern;
    EXPECT_EQ(stepper.attempt(field, 0.0, x, slope, h, tolerances, stages), Attempt::undefined);
    EXPECT_EQ(stepper.stages(), Stages::singular);
    ASSERT_EQ(stepper.attempt(field, 0.0, x, slope, 0.5 * h, tolerances, stages), Attempt::finite);
    EXPECT_EQ(stepper.x_new()[0], 0.0);
  }
}

// The stages of a jump that is met from both sides do not exist.
TEST_P(EachRadauMethod, SaysThatItsIterationDoesNotConverge) {
  const auto field = [](double, const double* x, double* f) { f[0] = x[0] > 0.0 ? -1.0 : 1.0; };
  const double x = 0.0, slope = 1.0;
  Stepper stepper(GetParam(), 1);
  EXPECT_EQ(stepper.attempt(field, 0.0, &x, &slope, 0.1, {}), Attempt::undefined);
  EXPECT_EQ(stepper.stages(), Stages::not_found);
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

/// Two masses at speeds of 1 rub on each other at a speed of 1e-9: differences of the size of rounding of the speeds
/// see the other end of the law of friction.
TEST(Radau5, AKnownJacobianServesWhereDifferencesSeeNothing) {
  constexpr double layer = 1e-9;
  const auto friction = [](const double* x) { return std::tanh((x[0] - x[1]) / layer); };
  const auto f = [&](double t, const double* x, double* xdot) {
    xdot[0] = 1.0 + std::sin(t) - friction(x);
    xdot[1] = friction(x);
  };
  for (const bool is_known : {false, true}) {
    const auto derivatives = [&](double, const double* x, double* entries) {
      const double slope = (1.0 - friction(x) * friction(x)) / layer;
      entries[0] = entries[3] = -slope;
      entries[1] = entries[2] = slope;
      return is_known;
    };
    const JacobianFunction jacobian(derivatives);
    Stepper stepper(Method::radau5, 2);
    // Both accelerate alike.
    const double x[] = {1.0 + layer * std::atanh(0.5), 1.0};
    double slope[2];
    f(0.0, x, slope);
    double h = 4e-3;
    auto outcome = Attempt::undefined;
    for (int length = 0; length < 5 && outcome == Attempt::undefined; ++length) {
      h *= 0.5;
      outcome = stepper.attempt(f, 0.0, x, slope, h, {1e-8, 1e-10}, {.functions = {}, .jacobian = &jacobian});
    }
    ASSERT_EQ(outcome, is_known ? Attempt::finite : Attempt::undefined);
    if (!is_known) continue;
    EXPECT_LE(stepper.error_norm(), 1.0);
    const double common = 0.5 * (h + 1.0 - std::cos(h));
    EXPECT_NEAR(stepper.x_new()[1], 1.0 + common, 1e-9);
  }
}

// L-stable: a perturbation is gone after one step that is long against its time.
TEST_P(EachRadauMethod, DampsStiffComponentsInOneStep) {
  const auto f = [](double t, const double* x, double* xdot) { *xdot = -1e8 * (*x - std::cos(t)) - std::sin(t); };
  EXPECT_NEAR(fixed_steps(GetParam(), f, {2.0}, 0.0, 0.1, 1)[0], std::cos(0.1), 1e-5);
}

// Its column has an entry in another row that is larger than that on the diagonal, and serves as a pivot.
TEST_P(EachRadauMethod, AStateWithoutARateKeepsItsBits) {
  const auto f = [](double t, const double* x, double* xdot) {
    xdot[0] = xdot[1] = 0.0;
    xdot[2] = 1e12 * (x[0] - 3.0 * x[1]) * (1.0 + x[3]) - x[2];
    xdot[3] = std::cos(t) + 1e11 * x[1] * x[2];
  };
  const auto x = fixed_steps(GetParam(), f, {0.0, 0.0, 1.0, 0.5}, 0.0, 0.1, 3);
  EXPECT_EQ(x[0], 0.0);
  EXPECT_EQ(x[1], 0.0);
}

/// Van der Pol in the scaling of Hairer & Wanner, IV.10: 1 / mu^2 = 1e-6.
struct VanDerPol {
  void operator()(double /*t*/, const double* x, double* xdot) const {
    xdot[0] = x[1];
    xdot[1] = ((1.0 - x[0] * x[0]) * x[1] - x[0]) / 1e-6;
  }
};

TEST_P(EachRadauMethod, VanDerPol) {
  // Values at t = 2 from the Test Set for IVP Solvers (vdpol). The two jumps amplify local errors.
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const Tolerances tolerances{.rtol = tolerance, .atol = tolerance};
    const Trajectory run = controlled_steps(GetParam(), VanDerPol{}, {2.0, 0.0}, 0.0, 2.0, tolerances);
    EXPECT_NEAR(run.x[0], 0.1706167732170483e1, 50 * tolerance);
    EXPECT_NEAR(run.x[1], -0.8928097010247975, 50 * tolerance);
    // Lengths of the longest steps are not foreseen as well in the layers.
    EXPECT_LT(run.rejected, run.accepted / (GetParam() == Method::radau13 ? 2 : 4));
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

TEST_P(EachRadauMethod, Robertson) {
  const auto f = [](double, const double* x, double* xdot) {
    xdot[0] = -0.04 * x[0] + 1e4 * x[1] * x[2];
    xdot[2] = 3e7 * x[1] * x[1];
    xdot[1] = -xdot[0] - xdot[2];
  };
  const Trajectory run = controlled_steps(GetParam(), f, {1.0, 0.0, 0.0}, 0.0, 1e11, {.rtol = 1e-9, .atol = 1e-15});
  // Hairer & Wanner, test set of IV.10, t = 1e11.
  EXPECT_NEAR(run.x[0], 0.2083340149701255e-7, 1e-13);
  EXPECT_NEAR(run.x[1], 0.8333360770334713e-13, 1e-18);
  EXPECT_NEAR(run.x[2], 0.9999999791665050, 1e-9);
  EXPECT_LT(run.accepted + run.rejected, 4000);
}

TEST_P(EachRadauMethod, ARetakenStepDependsOnNothingButItsLength) {
  const auto start = fixed_steps(GetParam(), VanDerPol{}, {2.0, -0.66}, 0.0, 0.1, 200);
  std::vector<double> slope(2);
  VanDerPol{}(0.1, start.data(), slope.data());
  const auto retaken = [&](double detour) {
    Stepper stepper(GetParam(), 2);
    for (const double h : {0.02, detour, 0.013}) {
      EXPECT_EQ(stepper.attempt(VanDerPol{}, 0.1, start.data(), slope.data(), h, {}), Attempt::finite);
    }
    return std::vector<double>(stepper.x_new(), stepper.x_new() + 2);
  };
  EXPECT_EQ(retaken(0.01), retaken(0.002));
}

TEST_P(EachRadauMethod, EndsOfRetakenStepsLieOnOneSmoothCurve) {
  const auto x = Kepler::exact(0.2);
  std::vector<double> slope(x.size());
  Kepler{}(0.2, x.data(), slope.data());
  Stepper stepper(GetParam(), Kepler::n);
  const auto end = [&](double h) {
    EXPECT_EQ(stepper.attempt(Kepler{}, 0.2, x.data(), slope.data(), h, {}), Attempt::finite);
    return stepper.x_new()[0];
  };
  // Second differences over 2^-30 are rounding, and nothing but rounding.
  for (int k = 0; k < 100; ++k) {
    const double h = 0.2 + 0.001 * k;
    const double bend = end(h + 0x1p-30) - 2.0 * end(h) + end(h - 0x1p-30);
    EXPECT_LT(std::abs(bend), 16 * rounding_growth(GetParam()) * epsilon) << h;
  }
}

TEST_P(EachRadauMethod, RestartForgetsTheStepsBefore) {
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
  Stepper fresh(GetParam(), Kepler::n);
  Stepper used(GetParam(), Kepler::n);
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

TEST_P(EachRadauMethod, UndefinedRightHandSidesShortenTheStep) {
  // Defined to x = 1 only.
  const auto f = [](double, const double* x, double* xdot) { *xdot = 1.0 + std::sqrt(1.0 - *x); };
  Stepper stepper(GetParam(), 1);
  const double x = 0.0;
  const double slope = 2.0;
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &slope, 2.0, {}), Attempt::undefined);
  EXPECT_EQ(stepper.attempt(f, 0.0, &x, &slope, 0.1, {}), Attempt::finite);
  const double again = *stepper.x_new();
  Stepper fresh(GetParam(), 1);
  ASSERT_EQ(fresh.attempt(f, 0.0, &x, &slope, 0.1, {}), Attempt::finite);
  EXPECT_NEAR(again, *fresh.x_new(), (rounding_growth(GetParam()) - 1.0) * epsilon);  // of radau5: the same
}

TEST_P(EachRadauMethod, StartsAtTheEdgeOfItsDomain) {
  // x' = sqrt(x) + 1 from 0: the Jacobian is differenced into the domain.
  const auto f = [](double, const double* x, double* xdot) { *xdot = std::sqrt(*x) + 1.0; };
  const Trajectory run = controlled_steps(GetParam(), f, {0.0}, 0.0, 1.0, {.rtol = 1e-8, .atol = 1e-8});
  // 2 (u - log(1 + u)) = t with u = sqrt(x)
  const double u = std::sqrt(run.x[0]);
  EXPECT_NEAR(2.0 * (u - std::log1p(u)), 1.0, 1e-6);
}

int stiff_after(Method method, RightHandSide f, std::vector<double> x, int steps, double h) {
  Stepper stepper(method, static_cast<int>(x.size()));
  StiffnessWatch watch;
  const Tolerances tolerances{1e-6, 1e-8};
  std::vector<double> slope(x.size());
  f(0.0, x.data(), slope.data());
  for (int k = 0; k < steps; ++k) {
    stepper.attempt(f, k * h, x.data(), slope.data(), h, tolerances);
    std::copy_n(stepper.x_new(), x.size(), x.begin());
    std::copy_n(stepper.slope_new(), x.size(), slope.begin());
    if (watch.looks_stiff(stepper, tolerances)) return k;
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
    EXPECT_EQ(stiff_after(method, f, {1.0, 1.0}, 100, 0.6 * limit / 1000.0), -1);
  }
  EXPECT_EQ(stiff_after(Method::radau5, VanDerPol{}, {2.0, -0.66}, 100, 1e-3), -1);
}

// A large component that moves slowly does not hide a small one that is stiff.
TEST(StiffnessWatch, MeasuresInUnitsOfTheTolerances) {
  constexpr double large = 1e6, small = 1e-5;
  const auto f = [](double t, const double* x, double* xdot) {
    xdot[0] = -1000.0 * (x[0] - small * std::cos(t));
    xdot[1] = large * std::sin(t);
  };
  for (const Method method : explicit_methods) {
    const double limit = method == Method::dopri5 ? 3.25 : 6.1;
    EXPECT_NE(stiff_after(method, f, {small, large}, 100, 1.01 * limit / 1000.0), -1);
    EXPECT_EQ(stiff_after(method, f, {small, large}, 100, 0.6 * limit / 1000.0), -1);
  }
}

/// Dry friction, stronger than the drive, on a mass at a speed of 1 turns to and fro below the tolerances; an
/// oscillator has steps as long for its time.
TEST(StiffnessWatch, SeesForcesThatTurnBelowTheTolerances) {
  const auto friction = [](double t, const double* x, double* xdot) {
    const double vx = x[0] - 1.0, vy = x[1] - 1.0, speed = std::hypot(vx, vy);
    xdot[0] = 0.9 * std::cos(t) - vx / speed;
    xdot[1] = 0.9 * std::sin(t) - vy / speed;
  };
  const auto oscillator = [](double, const double* x, double* xdot) {
    xdot[0] = x[1];
    xdot[1] = -x[0];
  };
  for (const Method method : explicit_methods) {
    EXPECT_NE(stiff_after(method, friction, {1.0 + 1e-9, 1.0}, 1000, 1e-7), -1);
    EXPECT_EQ(stiff_after(method, oscillator, {1.0, 0.0}, 1000, 1.5), -1);
  }
}

}  // namespace
}  // namespace saltus::ode
