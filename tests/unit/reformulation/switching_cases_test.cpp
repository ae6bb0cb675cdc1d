// The four switching cases of Example 3 of [nurkanovic2024] (its Fig. 2) along their exact solutions: the relations
// (17) and (22), and the signs of Table 2.
#include <cmath>
#include <functional>
#include <vector>

#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "dcs_tools.hpp"

namespace saltus::reformulation {
namespace {

using casadi::SX;
using model::Builder;

constexpr double switch_time = 1.0;

/// A scalar inclusion and its solution; x and alpha over time, the switch at t = 1.
struct Case {
  std::string name;
  std::function<SX(Builder&, const SX&)> rate;
  std::function<double(double)> x, rate_of_x, alpha;
  /// Table 2: whether the sums of lambda_n and lambda_p before (B) and after (F) the switch are positive.
  bool n_before, n_after, p_before, p_after;
};

std::vector<Case> cases() {
  const auto before = [](double t) { return t < switch_time; };
  return {
      // (a) is printed as 2 sign(x), "same system as in Example 2"; that one is 1 for x > 0 and 3 for x < 0.
      {"crossing", [](Builder& b, const SX& x) { return 2 - b.sign(x); },
       [=](double t) { return before(t) ? 3 * (t - 1) : t - 1; }, [=](double t) { return before(t) ? 3.0 : 1.0; },
       [=](double t) { return before(t) ? 0.0 : 1.0; }, true, false, false, true},
      {"entering sliding", [](Builder& b, const SX& x) { return -b.sign(x) + 0.2 * sin(5 * b.time()); },
       [=](double t) { return before(t) ? t - 1 + 0.04 * (std::cos(5.0) - std::cos(5 * t)) : 0.0; },
       [=](double t) { return before(t) ? 1 + 0.2 * std::sin(5 * t) : 0.0; },
       [=](double t) { return before(t) ? 0.0 : (1 + 0.2 * std::sin(5 * t)) / 2; }, true, false, false, false},
      {"leaving sliding", [](Builder& b, const SX& x) { return -b.sign(x) + b.time(); },
       [=](double t) { return before(t) ? 0.0 : (t - 1) * (t - 1) / 2; },
       [=](double t) { return before(t) ? 0.0 : t - 1; }, [=](double t) { return before(t) ? (1 + t) / 2 : 1.0; },
       false, false, false, true},
      {"spontaneous switch", [](Builder& b, const SX& x) { return b.sign(x); },
       [=](double t) { return before(t) ? 0.0 : t - 1; }, [=](double t) { return before(t) ? 0.0 : 1.0; },
       [=](double t) { return before(t) ? 0.5 : 1.0; }, false, false, false, true},
  };
}

model::System system_of(const Case& c) {
  Builder builder(c.name);
  const SX x = builder.state("x", {0.0});
  builder.dynamics("x", c.rate(builder, x));
  return built(builder);
}

/// psi = lambda_p - lambda_n, both >= 0 and one of them 0: (17).
struct Multipliers {
  double n, p;
};
Multipliers multipliers(const Dcs& dcs, double x) {
  const double psi = indicators(dcs, {x})[0];
  return {-std::min(psi, 0.0), std::max(psi, 0.0)};
}

TEST(SwitchingCases, ExactSolutionsSolveTheStepForm) {
  for (const Case& c : cases()) {
    const Dcs dcs = dcs_of(system_of(c), {.reformulation = Form::step});
    ASSERT_EQ(dcs.parts.size(), 1u);
    const casadi::Function f("f", {dcs.t, dcs.x, dcs.selection}, {dcs.f});
    Multipliers last = multipliers(dcs, c.x(0.0));
    for (int k = 0; k <= 200; ++k) {
      const double t = 0.01 * k;
      const double alpha = c.alpha(t);
      const Multipliers lambda = multipliers(dcs, c.x(t));
      EXPECT_NEAR(static_cast<double>(f(std::vector<casadi::DM>{t, c.x(t), alpha}).front()), c.rate_of_x(t), 1e-14)
          << c.name << " " << t;
      EXPECT_GE(alpha, 0.0);
      EXPECT_LE(alpha, 1.0);
      // Products: (22d), (22e). The exact solution of (b) is 0 to rounding only.
      EXPECT_NEAR(lambda.n * alpha, 0.0, 1e-15) << c.name << " " << t;
      EXPECT_NEAR(lambda.p * (1 - alpha), 0.0, 1e-15) << c.name << " " << t;
      // Continuous, as x is: no faster than the rate.
      EXPECT_LE(std::abs(lambda.n - last.n), 0.031) << c.name << " " << t;
      EXPECT_LE(std::abs(lambda.p - last.p), 0.031) << c.name << " " << t;
      last = lambda;
    }
    const Multipliers at_switch = multipliers(dcs, c.x(switch_time));
    EXPECT_NEAR(at_switch.n + at_switch.p, 0.0, 1e-16) << c.name;
  }
}

/// The same solutions in Stewart's form: theta = (alpha, 1 - alpha), lambda = g - min g (28).
TEST(SwitchingCases, ExactSolutionsSolveStewartsForm) {
  for (const Case& c : cases()) {
    const Dcs dcs = dcs_of(system_of(c), {.reformulation = Form::stewart});
    const casadi::Function f("f", {dcs.t, dcs.x, dcs.selection}, {dcs.f});
    for (int k = 0; k <= 200; ++k) {
      const double t = 0.01 * k;
      const std::vector<double> theta{c.alpha(t), 1 - c.alpha(t)};
      const auto g = indicators(dcs, {c.x(t)});
      EXPECT_EQ(g, (std::vector<double>{-c.x(t), c.x(t)}));
      EXPECT_NEAR(static_cast<double>(f(std::vector<casadi::DM>{t, c.x(t), theta}).front()), c.rate_of_x(t), 1e-14)
          << c.name << " " << t;
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(theta[i] * (g[i] - std::min(g[0], g[1])), 0.0, 1e-15) << c.name << " " << t;
      }
    }
  }
}

/// The row "no switch" of Table 2 is the first half of the crossing. pi and nu are products and sums of the columns; of
/// the rows that switch every nu is 0. So is that of sliding without a switch, which the table leaves out: its nu does
/// not tell that nothing changes, and (39) leaves the lengths of two elements that slide undetermined.
TEST(SwitchingCases, SumsOfMultipliersAreThoseOfTable2) {
  const auto sums = [](const Dcs& dcs, const Case& c, double from) {
    Multipliers sum{0, 0};
    for (const double node : {0.0, 0.15, 0.64, 1.0}) {
      const Multipliers lambda = multipliers(dcs, c.x(from + 0.5 * node));
      sum.n += lambda.n;
      sum.p += lambda.p;
    }
    return sum;
  };
  const auto nu = [](const Multipliers& b, const Multipliers& f) { return b.n * f.n + b.p * f.p; };
  for (const Case& c : cases()) {
    const Dcs dcs = dcs_of(system_of(c), {.reformulation = Form::step});
    const auto before = sums(dcs, c, 0.5), after = sums(dcs, c, 1.0);
    EXPECT_EQ(before.n > 1e-12, c.n_before) << c.name;
    EXPECT_EQ(after.n > 1e-12, c.n_after) << c.name;
    EXPECT_EQ(before.p > 1e-12, c.p_before) << c.name;
    EXPECT_EQ(after.p > 1e-12, c.p_after) << c.name;
    EXPECT_NEAR(nu(before, after), 0.0, 1e-15) << c.name;
  }
  const auto all = cases();
  const auto dcs = [&](std::size_t i) { return dcs_of(system_of(all[i]), {.reformulation = Form::step}); };
  EXPECT_GT(nu(sums(dcs(0), all[0], 0.0), sums(dcs(0), all[0], 0.5)), 0.1) << "no switch";
  EXPECT_NEAR(nu(sums(dcs(1), all[1], 1.0), sums(dcs(1), all[1], 1.5)), 0.0, 1e-15) << "sliding, no switch";
}

}  // namespace
}  // namespace saltus::reformulation
