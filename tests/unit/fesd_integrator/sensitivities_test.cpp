// Sensitivities of the discretisation: closed forms, central differences, and what time-stepping makes of them.
#include "saltus/fesd_integrator/sensitivities.hpp"

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

struct Settings {
  TableauFamily family = TableauFamily::radau_iia;
  int stages = 3;
  long steps = 40;
  Form form = Form::step;
  IntegrationOptions::Switches switches = IntegrationOptions::Switches::detected;
};

Integration run(model::System system, double until, const Settings& settings) {
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
      const auto integration = run(system, 2.0, {family, stages, 7, form});
      expect_near(integration.sensitivities->x0, {{1.0 / 3.0}}, 1e-12);
    }
  }
}

TEST(Sensitivities, TimeSteppingGivesAWrongValueForEveryStep) {
  const auto system = crossing();
  for (const long steps : {7L, 70L, 700L}) {
    const auto integration =
        run(system, 2.0, {TableauFamily::radau_iia, 1, steps, Form::step, IntegrationOptions::Switches::fixed});
    EXPECT_GT(std::abs(integration.sensitivities->x0[0][0] - 1.0 / 3.0), 0.3) << steps;
  }
}

TEST(Sensitivities, TheRotatingOscillatorHasItsMatrix) {
  const std::vector<std::vector<double>> exact{{21.66946501324, -2.06995427137}, {56.63750249010, -4.34234751571}};
  const auto system = rotating_oscillator();
  for (const auto form : {Form::step, Form::stewart}) {
    expect_near(run(system, std::numbers::pi / 2.0, {TableauFamily::radau_iia, 5, 40, form}).sensitivities->x0, exact,
                1e-9);
  }
  expect_near(run(system, std::numbers::pi / 2.0, {TableauFamily::gauss_legendre, 4, 40}).sensitivities->x0, exact,
              1e-8);
}

TEST(Sensitivities, TheyConvergeWithTheOrderOfTheMethod) {
  const auto system = rotating_oscillator();
  std::array<double, 2> errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto integration = run(system, std::numbers::pi / 2.0, {TableauFamily::radau_iia, 2, i == 0 ? 80L : 160L});
    errors[i] = std::abs(integration.sensitivities->x0[0][0] - 21.66946501324);
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 3.0, 0.5);
}

/// Central differences of step d have an error of d^2 and of 1e-14 / d by roundings, both below 1e-9 here; what the
/// projection of Gauss methods leaves out is of the order of their local error.
TEST(Sensitivities, TheyAreTheDerivativesOfTheDiscreteSolution) {
  constexpr double d = 1e-5;
  for (const auto form : {Form::step, Form::stewart}) {
    for (const auto& [family, stages] : families) {
      const Settings settings{family, stages, 30, form};
      const auto system = driven();
      const auto integration = run(system, 10.0, settings);
      // Crosses, slides, leaves.
      ASSERT_GE(integration.events.size(), 3U);
      const auto difference = [&](auto change) {
        std::array<std::vector<double>, 2> ends;
        for (const int sign : {-1, 1}) {
          auto changed = system;
          change(changed, sign * d);
          ends[sign > 0 ? 1 : 0] = run(changed, 10.0, settings).final.x;
        }
        std::vector<double> quotient;
        for (std::size_t i = 0; i < ends[0].size(); ++i) quotient.push_back((ends[1][i] - ends[0][i]) / (2.0 * d));
        return quotient;
      };
      for (std::size_t j = 0; j < 2; ++j) {
        const auto of_x0 = difference([&](model::System& s, double by) { s.initial_state[j] += by; });
        const auto of_p = difference([&](model::System& s, double by) { s.parameter_values[j] += by; });
        for (std::size_t i = 0; i < 2; ++i) {
          const double tolerance = family == TableauFamily::gauss_legendre ? 1e-4 : 1e-6;
          EXPECT_NEAR(integration.sensitivities->x0[i][j], of_x0[i], tolerance) << i << j << " " << stages;
          EXPECT_NEAR(integration.sensitivities->p[i][j], of_p[i], tolerance) << i << j << " " << stages;
        }
      }
    }
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
