// Sensitivities of the discretisation: closed forms, central differences, and what time-stepping makes of them.
#include "saltus/fesd_integrator/tangent/sensitivities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;

struct Discretization {
  TableauFamily family = TableauFamily::radau_iia;
  int stages = 3;
  long steps = 40;
  Form form = Form::step;
  IntegrationOptions::Switches switches = IntegrationOptions::Switches::detected;
};

Integration run_with(model::System system, double until, const Discretization& settings) {
  const auto dcs = reformulation::reformulate(system, {settings.form, std::nullopt});
  EXPECT_TRUE(dcs.has_value());
  IntegrationOptions options;
  options.switches = settings.switches;
  options.tableau = *discretization::butcher_tableau(settings.family, settings.stages);
  options.until = until;
  options.steps = settings.steps;
  options.sensitivities = true;
  auto integration = integrate(system, *dcs, options);
  EXPECT_TRUE(integration.has_value());
  EXPECT_EQ(integration->status.termination, result::Termination::completed) << integration->status.message;
  return std::move(*integration);
}

/// x' = 2 - sign x from x0 = -1: x(T) = T - t_s, t_s = -x0 / 3.
model::System crossing() {
  model::Builder builder("crossing");
  const SX x = builder.state("x", {-1.0});
  builder.dynamics("x", 2.0 - builder.sign(x));
  return *builder.build();
}

/// x' = A x, whose rotation turns round at |x| = 1.
model::System rotating_oscillator() {
  model::Builder builder("rotating-oscillator");
  const SX x1 = builder.state("x1", {std::exp(-1.0)});
  const SX x2 = builder.state("x2", {0.0});
  const SX turn = 2.0 * std::numbers::pi * builder.sign(x1 * x1 + x2 * x2 - 1.0);
  builder.dynamics("x1", x1 + turn * x2);
  builder.dynamics("x2", x2 - turn * x1);
  return *builder.build();
}

/// A driven oscillator with dry friction on a surface that moves: crosses, slides, leaves.
model::System driven() {
  model::Builder builder("driven");
  const SX mu = builder.parameter("mu", 0.8);
  const SX k = builder.parameter("k", 1.3);
  const SX q = builder.state("q", {1.2});
  const SX v = builder.state("v", {-0.5});
  const SX t = builder.time();
  builder.dynamics("q", v);
  builder.dynamics("v", -k * q + 0.6 * sin(t) - mu * builder.sign(v - 0.1 * t + 0.05 * q * q));
  return *builder.build();
}

void expect_near(const std::vector<std::vector<double>>& found, const std::vector<std::vector<double>>& exact,
                 double tolerance) {
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].size(), exact[i].size());
    for (std::size_t j = 0; j < found[i].size(); ++j) {
      EXPECT_NEAR(found[i][j], exact[i][j], tolerance * std::max(1.0, std::abs(exact[i][j]))) << i << ", " << j;
    }
  }
}

/// Families with the number of stages that suits the tests.
constexpr std::array families{std::pair{TableauFamily::radau_iia, 3}, std::pair{TableauFamily::gauss_legendre, 2},
                              std::pair{TableauFamily::lobatto_iiic, 3}, std::pair{TableauFamily::explicit_rk, 4}};

TEST(Sensitivities, ACrossingHasTheRatioOfItsSpeeds) {
  const auto system = crossing();
  for (const auto form : {Form::step, Form::stewart}) {
    for (const auto& [family, stages] : families) {
      const auto integration = run_with(system, 2.0, {family, stages, 7, form});
      expect_near(integration.sensitivities->x0, {{1.0 / 3.0}}, 1e-12);
    }
  }
}

TEST(Sensitivities, TimeSteppingGivesAWrongValueForEveryStep) {
  const auto system = crossing();
  for (const long steps : {7L, 70L, 700L}) {
    const auto integration =
        run_with(system, 2.0, {TableauFamily::radau_iia, 1, steps, Form::step, IntegrationOptions::Switches::fixed});
    EXPECT_GT(std::abs(integration.sensitivities->x0[0][0] - 1.0 / 3.0), 0.3) << steps;
  }
}

TEST(Sensitivities, TheRotatingOscillatorHasItsMatrix) {
  const std::vector<std::vector<double>> exact{{21.66946501324, -2.06995427137}, {56.63750249010, -4.34234751571}};
  const auto system = rotating_oscillator();
  for (const auto form : {Form::step, Form::stewart}) {
    expect_near(run_with(system, std::numbers::pi / 2.0, {TableauFamily::radau_iia, 5, 40, form}).sensitivities->x0,
                exact, 1e-9);
  }
  expect_near(run_with(system, std::numbers::pi / 2.0, {TableauFamily::gauss_legendre, 4, 40}).sensitivities->x0, exact,
              1e-8);
}

TEST(Sensitivities, TheyConvergeWithTheOrderOfTheMethod) {
  const auto system = rotating_oscillator();
  std::array<double, 2> errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto integration =
        run_with(system, std::numbers::pi / 2.0, {TableauFamily::radau_iia, 2, i == 0 ? 80L : 160L});
    errors[i] = std::abs(integration.sensitivities->x0[0][0] - 21.66946501324);
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 3.0, 0.5);
}

/// Central differences of the end state: columns over initial states, then over parameters.
std::vector<std::vector<double>> differences(const model::System& system, double until, const Discretization& settings,
                                             double d) {
  std::vector<std::vector<double>> rows(system.initial_state.size());
  const auto add = [&](auto change) {
    std::array<std::vector<double>, 2> ends;
    for (const int sign : {-1, 1}) {
      auto changed = system;
      change(changed, sign * d);
      ends[sign > 0 ? 1 : 0] = run_with(changed, until, settings).final.x;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].push_back((ends[1][i] - ends[0][i]) / (2.0 * d));
  };
  for (std::size_t j = 0; j < system.initial_state.size(); ++j) {
    add([&](model::System& s, double by) { s.initial_state[j] += by; });
  }
  for (std::size_t j = 0; j < system.parameter_values.size(); ++j) {
    add([&](model::System& s, double by) { s.parameter_values[j] += by; });
  }
  return rows;
}

/// x0 and p side by side.
std::vector<std::vector<double>> side_by_side(const result::Sensitivities& sensitivities) {
  auto rows = sensitivities.x0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].insert(rows[i].end(), sensitivities.p[i].begin(), sensitivities.p[i].end());
  }
  return rows;
}

/// Central differences of step d have an error of d^2 and of 1e-14 / d by roundings, both below 1e-9 here.
constexpr double d = 1e-5;

TEST(Sensitivities, TheyAreTheDerivativesOfTheDiscreteSolution) {
  const auto system = driven();
  for (const auto form : {Form::step, Form::stewart}) {
    for (const auto& [family, stages] : families) {
      SCOPED_TRACE(stages);
      const Discretization settings{family, stages, 30, form};
      const auto integration = run_with(system, 10.0, settings);
      // Crosses, slides, leaves.
      ASSERT_GE(integration.events.size(), 3U);
      expect_near(side_by_side(*integration.sensitivities), differences(system, 10.0, settings, d), 1e-6);
    }
  }
}

/// A spiral reaches the unit circle, whose field pulls it there in a direction that turns with it.
model::System pulled_to_a_circle() {
  model::Builder builder("circle");
  const SX push = builder.parameter("push", 0.3);
  const SX radius = builder.parameter("radius", 1.0);
  const SX x = builder.state("x", {1.5});
  const SX y = builder.state("y", {0.0});
  const SX t = builder.time();
  const SX turn = 1.0 + x / 2.0;
  const SX pull = builder.sign(x * x + y * y - radius * radius * (1.0 + 0.1 * t));
  builder.dynamics("x", -turn * y - pull * (x + 0.2 * y * y));
  builder.dynamics("y", turn * x - pull * y / 2.0 + push);
  return *builder.build();
}

TEST(Sensitivities, TheProjectionOfGaussMethodsTurnsWithItsEnd) {
  // Coarse: what the change of the direction adds is of the order of the local error, here 1e-2 to 1e-4.
  const auto system = pulled_to_a_circle();
  for (const auto form : {Form::step, Form::stewart}) {
    for (const int stages : {1, 2, 3}) {
      SCOPED_TRACE(stages);
      const Discretization settings{TableauFamily::gauss_legendre, stages, 8, form};
      const auto integration = run_with(system, 4.0, settings);
      ASSERT_EQ(integration.final.mode, result::Mode{0});
      expect_near(side_by_side(*integration.sensitivities), differences(system, 4.0, settings, d), 1e-7);
    }
  }
}

/// x' = -x + 2 step(t - p) + step(t - s) + 0.1 floor(t / q): a parameter, a discrete state and a scale move times of
/// events.
model::System moved_events() {
  model::Builder builder("moved");
  const SX p = builder.parameter("p", 0.613);
  const SX q = builder.parameter("q", 0.37);
  const SX x = builder.state("x", {1.0});
  const SX s = builder.discrete_state("s", 1.234);
  const SX t = builder.time();
  builder.dynamics("x", -x + 2.0 * builder.step(t - p) + builder.step(t - s) + 0.1 * builder.floor(t / q) +
                            0.2 * builder.sign(x - 0.7));
  return *builder.build();
}

TEST(Sensitivities, TimesOfEventsMoveWithParametersAndDiscreteStates) {
  const auto system = moved_events();
  for (const auto& [family, stages] : families) {
    SCOPED_TRACE(stages);
    const Discretization settings{family, stages, 11, Form::step};
    const auto integration = run_with(system, 2.0, settings);
    const auto found = side_by_side(*integration.sensitivities);
    expect_near(found, differences(system, 2.0, settings, d), 1e-7);
    // d x(2) / d s = -exp(-(2 - s)): x is above 0.7 by then.
    if (stages > 2) {
      EXPECT_NEAR(found[0][1], -std::exp(1.234 - 2.0), 1e-4);
    }
  }
  // The same of time-stepping, where nothing of psi switches.
  auto without = system;
  without.initial_state[0] = 3.0;
  const Discretization fixed{TableauFamily::radau_iia, 2, 11, Form::step, IntegrationOptions::Switches::fixed};
  expect_near(side_by_side(*run_with(without, 2.0, fixed).sensitivities), differences(without, 2.0, fixed, d), 1e-7);
}

TEST(Sensitivities, AnEventAtTheEndOfAStepCountsAsOne) {
  model::Builder builder("grid");
  const SX p = builder.parameter("p", 0.5);
  const SX x = builder.state("x", {1.0});
  builder.dynamics("x", -x + builder.step(builder.time() - p));
  const auto integration = run_with(*builder.build(), 1.0, {TableauFamily::radau_iia, 3, 4});
  expect_near(side_by_side(*integration.sensitivities), {{std::exp(-1.0), -std::exp(-0.5)}}, 1e-6);
}

/// x reaches zero at t = 0.5, the end of a simulation step, and slides with alpha = 1/2 + p/4; y' = alpha.
TEST(Sensitivities, ASwitchAtTheEndOfAStepMovesOffIt) {
  model::Builder builder("grid");
  const SX p = builder.parameter("p", 1.0);
  const SX x = builder.state("x", {-1.5});
  builder.state("y", {0.0});
  builder.dynamics("x", p - 2.0 * builder.sign(x));
  builder.dynamics("y", builder.step(x));
  const auto entered = *builder.build();
  model::Builder other("grid");
  const SX z = other.state("x", {-1.5});
  other.dynamics("x", 2.0 - other.sign(z));
  const auto crossed = *other.build();
  for (const auto form : {Form::step, Form::stewart}) {
    for (const auto& [family, stages] : families) {
      for (const long steps : {4L, 8L, 100L}) {
        const Discretization settings{family, stages, steps, form};
        expect_near(run_with(crossed, 2.0, settings).sensitivities->x0, {{1.0 / 3.0}}, 1e-12);
        expect_near(side_by_side(*run_with(entered, 2.0, settings).sensitivities), {{0.0, 0.0, 0.0}, {0.25, 1.0, 0.5}},
                    1e-12);
      }
    }
  }
}

TEST(Sensitivities, EventsAtOneTimeThatMoveApartAreNotDefined) {
  model::Builder builder("two");
  const SX p = builder.parameter("p", 0.25);
  const SX q = builder.parameter("q", 0.25);
  const SX x = builder.state("x", {1.0});
  const SX t = builder.time();
  builder.dynamics("x", -x + builder.step(t - p) + builder.step(4.0 * t * t - q));
  const auto integration = run_with(*builder.build(), 1.0, {TableauFamily::radau_iia, 3, 3});
  EXPECT_TRUE(std::isnan(integration.sensitivities->p[0][0]));
  EXPECT_TRUE(std::isnan(integration.sensitivities->p[0][1]));
  EXPECT_NEAR(integration.sensitivities->x0[0][0], std::exp(-1.0), 1e-6);
}

}  // namespace
}  // namespace saltus::fesd_integrator
