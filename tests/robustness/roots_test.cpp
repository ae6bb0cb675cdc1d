// No root is missed, none is found twice, at any tolerance.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::Integrator;
using result::EventKind;

constexpr Integrator integrators[] = {Integrator::dopri5, Integrator::dop853, Integrator::radau5, Integrator::taylor};

/// 10^-3 … 10^-12 in steps of a factor 10^(9/(count - 1)).
std::vector<double> tolerances(int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(std::pow(10.0, -3.0 - 9.0 * i / (count - 1)));
  return values;
}

std::string setting(Integrator integrator, double rtol) {
  constexpr const char* names[] = {"dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"};
  return names[static_cast<std::size_t>(integrator)] + (", rtol = " + std::to_string(std::log10(rtol)));
}

// https://github.com/scipy/scipy/issues/9228: y = (t + 6)(t + 2)(t - 2) in one or two steps of a high order method.
constexpr const char* cubic = R"toml(
[model]
name = "cubic"
[states]
y = -120
[dynamics]
y = "3*t^2 + 12*t - 4"
[[events]]
name = "zero"
when = "y"
[simulate]
from = -8
until = 10
)toml";

TEST(Roots, ScipyIssue9228FindsThreeRootsAtEveryTolerance) {
  const Simulator model = Simulator::from_text(cubic);
  for (const Integrator integrator : integrators) {
    for (const double rtol : tolerances(41)) {
      SCOPED_TRACE(setting(integrator, rtol));
      const result::Result result = model.run(with(model.options(), {integrator, rtol, rtol / 100}));
      ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
      ASSERT_EQ(result.events.size(), 3u);
      const double roots[] = {-6, -2, 2};
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(result.events[i].kind, EventKind::user);
        EXPECT_EQ(result.events[i].name, "zero");
        // all methods integrate a cubic exactly; rounding of |y| <= 120 at slopes of 16 and more
        EXPECT_NEAR(result.events[i].t, roots[i], 1e-11);
      }
    }
  }
}

TEST(Roots, RelayHas34EventsAtEveryTolerance) {
  const ReferenceProblem& problem = reference("relay-feedback");
  const Simulator model = Simulator::from_reference(problem);
  for (const Integrator integrator : integrators) {
    for (const double rtol : tolerances(41)) {
      SCOPED_TRACE(setting(integrator, rtol));
      const result::Result result = model.run(with(model.options(), {integrator, rtol, rtol / 100}));
      ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
      const std::vector<result::Event> switches = switches_of(result);
      EXPECT_EQ(switches.size(), 34u);
      for (std::size_t i = 0; i < switches.size(); ++i) {
        EXPECT_EQ(switches[i].kind, i % 2 == 0 ? EventKind::leave_sliding : EventKind::enter_sliding) << i + 1;
      }
    }
  }
}

// Two roots of psi in one step, with equal signs at its ends: 1e-3 deep, which no check of end signs sees.
constexpr const char* dip = R"toml(
[model]
name = "dip"
[states]
s = -2
x = 0
[switching]
surface = "s^2 - 0.001"
[dynamics]
s = "1"
x = "if(surface > 0, 1, 3)"
[simulate]
until = 4
)toml";

TEST(Roots, TwoRootsInOneStepAreFound) {
  const Simulator model = Simulator::from_text(dip);
  const double half_width = std::sqrt(0.001);
  for (const Integrator integrator : integrators) {
    for (const double rtol : tolerances(10)) {
      SCOPED_TRACE(setting(integrator, rtol));
      const result::Result result = model.run(with(model.options(), {integrator, rtol, rtol / 100}));
      ASSERT_EQ(result.events.size(), 2u);
      EXPECT_NEAR(result.events[0].t, 2 - half_width, 1e-12);
      EXPECT_NEAR(result.events[1].t, 2 + half_width, 1e-12);
      EXPECT_NEAR(result.final.x[1], 4 + 2 * 2 * half_width, 1e-12);
    }
  }
}

// The solution comes close to the surface in every turn; an interpolant may cross where the solution does not.
constexpr const char* near_touch = R"toml(
[model]
name = "near-touch"
[parameters]
gap = 0
[states]
x = 1
y = 0
[switching]
surface = "x - 1 - gap"
[dynamics]
x = "y"
y = "-x + if(surface > 0, 1, 0)"
[simulate]
until = 30
)toml";

TEST(Roots, NoEventWithoutARoot) {
  for (int k = 4; k <= 22; ++k) {
    const std::string gap_text = std::to_string(std::pow(10.0, -0.25 * k));
    const double gap = std::stod(gap_text);
    std::string text = near_touch;
    text.replace(text.find("gap = 0"), 7, "gap = " + gap_text);
    const Simulator model = Simulator::from_text(text);
    for (const Integrator integrator : integrators) {
      for (const double rtol : tolerances(10)) {
        SCOPED_TRACE(setting(integrator, rtol) + ", gap = " + gap_text);
        const result::Result result = model.run(with(model.options(), {integrator, rtol, rtol / 100}));
        // Accumulated errors may reach the surface; where an event is reported, it has been reached.
        for (const result::Event& event : result.events) EXPECT_NEAR(event.x[0], 1 + gap, 1e-12);
        EXPECT_TRUE(result.events.empty() || rtol > 1e-3 * gap);
      }
    }
  }
}

TEST(Roots, TwoLinesTakeAHandfulOfSteps) {
  const ReferenceProblem& problem = reference("two-lines");
  const Simulator model = Simulator::from_reference(problem);
  for (const Integrator integrator : integrators) {
    const result::Result result = model.run(with(model.options(), {integrator, 1e-8, 1e-10}));
    ASSERT_EQ(result.events.size(), 1u);
    // the growth of the step is limited by the controller, and it starts anew behind the event
    EXPECT_LE(result.statistics.steps + result.statistics.rejected, 20);
  }
}

/// x crosses the zero of an expression, and is faster behind it.
Simulator crossing_at(const std::string& expression) {
  return Simulator::from_text(
      "[model]\nname = \"flat\"\n[states]\nx = -0.5\n[dynamics]\nx = \"1 + 0.3*sin(3*t) + 0.1*sign(" + expression +
      ")\"\n[simulate]\nuntil = 3\n");
}

// Odd powers change sign where the simple function does, and are no more than their rounding for a while around it.
TEST(Roots, MultipleZerosAreLocatedLikeSimpleOnes) {
  for (const std::string level : {"-0.2", "0.3", "0.93", "1.1", "1.7"}) {
    const std::string base = "(x - (" + level + "))";
    for (const Integrator integrator : integrators) {
      const auto run = [&](const std::string& expression) {
        const Simulator model = crossing_at(expression);
        return model.run(with(model.options(), {integrator, 1e-9, 1e-12}));
      };
      const result::Result simple = run(base);
      ASSERT_EQ(simple.events.size(), 1u);
      for (const std::string power : {"^3", "^5"}) {
        SCOPED_TRACE(setting(integrator, 1e-9) + ", " + base + power);
        const result::Result multiple = run(base + power);
        ASSERT_EQ(multiple.status.termination, result::Termination::completed) << multiple.status.message;
        ASSERT_EQ(multiple.events.size(), 1u);
        // Bisection ends at neighbouring times: two roundings of t <= 3 each.
        EXPECT_NEAR(multiple.events[0].t, simple.events[0].t, 4e-15);
      }
    }
  }
}

// Multiplied out, the cube is nothing but rounding within 1e-5 of its zero: nobody can say when it changes sign.
TEST(Roots, AMultipleZeroThatIsLostInRoundingIsSaid) {
  for (const Integrator integrator : integrators) {
    SCOPED_TRACE(setting(integrator, 1e-9));
    const Simulator model = crossing_at("x^3 - 3*x^2 + 3*x - 1");
    const result::Result result = model.run(with(model.options(), {integrator, 1e-9, 1e-12}));
    EXPECT_EQ(result.status.termination, result::Termination::step_size_too_small);
    EXPECT_NE(result.status.message.find("a multiple zero"), std::string::npos) << result.status.message;
  }
}

}  // namespace
}  // namespace saltus::problems
