// Roots of switching functions that move, or are differences of large states: robust exact differentiators and
// observers, whose psi is no more than rounding of its terms long before its cycles are over.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::EventKind;
using result::Result;
using result::Termination;

/// The super-twisting differentiator of a signal: z0 follows it, z1 its derivative.
std::string differentiator(const std::string& signal, const std::string& gains, const std::string& start,
                           double until) {
  return fmt::format(R"toml(
[model]
name = "differentiator"
[parameters]
{}
[states]
{}
[definitions]
e = "z0 - ({})"
[dynamics]
z0 = "-k1*sqrt(abs(e))*sign(e) + z1"
z1 = "-k2*sign(e)"
[simulate]
until = {}
)toml",
                     gains, start, signal, until);
}

std::optional<Event> accumulation(const Result& result) {
  const auto found = std::find_if(result.events.begin(), result.events.end(),
                                  [](const Event& event) { return event.kind == EventKind::accumulation; });
  if (found == result.events.end()) return std::nullopt;
  return *found;
}

// z0 - (c + b t) and z1 - b are an autonomous super-twisting system, which is at rest after (1 + r)/(k2 (1 - r)).
TEST(Differentiator, OfARampIsExactAfterTheTimeOfSuperTwisting) {
  const double r = std::exp(-M_PI * (1.5 / 4) / std::sqrt(1.1 / 2 - 1.5 * 1.5 / 16));
  const double limit = (1 + r) / (1.1 * (1 - r));
  // psi is known to the rounding of its terms, r: cycles shorter than some hundred sqrt(r) are over, and the rest is
  // extrapolated. Steps of dopri5 are less accurate beside the root.
  const double rounded = 2e-6, loose = 4e-6;
  for (const double level : {0.0, 3.0, -50.0}) {
    const std::string start = fmt::format("z0 = {}\nz1 = -1", level);
    const std::string text = differentiator(fmt::format("{} - 2*t", level), "k1 = 1.5\nk2 = 1.1", start, 3.0);
    for (const auto& accuracy :
         {fine, Accuracy{pipeline::Integrator::dop853, 1e-8, 1e-10}, standard, fine_explicit, implicit}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << level << ' ' << result.status.message;
      const bool is_dop853 = accuracy.integrator == pipeline::Integrator::dop853;
      ASSERT_TRUE(accumulation(result).has_value());
      EXPECT_NEAR(accumulation(result)->t, limit, is_dop853 ? rounded : loose) << level;
      EXPECT_LE(result.events.size(), 12U) << level;
      EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
      EXPECT_NEAR(result.final.x[0], level - 6.0, 1e-13 * (1.0 + std::abs(level)));
      EXPECT_NEAR(result.final.x[1], -2.0, 1e-14);
      EXPECT_NEAR(result.final.alpha[0], 0.5, 1e-9);
    }
  }
}

// On the signal: z1 = d/dt, and the selection is what makes z1 the second derivative: alpha = 1/2 + sin(t)/(2 k2).
TEST(Differentiator, FollowsASignalThatCurves) {
  // From (0.01, 1) few cycles are left before the limit; with radau5 from (0.93771, -2.36334) stages that begin at the
  // state are beyond the surface, which moves.
  for (const char* start : {"z0 = 0\nz1 = 0", "z0 = 0.3\nz1 = 0", "z0 = -0.5\nz1 = 2", "z0 = 0.01\nz1 = 1",
                            "z0 = 0.93771\nz1 = -2.36334"}) {
    const std::string text = differentiator("sin(t)", "k1 = 2.121320343559643\nk2 = 2.2", start, 6.0);
    for (const auto& accuracy :
         {standard, Accuracy{pipeline::Integrator::dop853, 1e-8, 1e-10}, fine, fine_explicit, implicit}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << start << result.status.message;
      ASSERT_TRUE(accumulation(result).has_value());
      EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
      EXPECT_NEAR(result.final.x[0], std::sin(6.0), 1e-14);
      EXPECT_NEAR(result.final.x[1], std::cos(6.0), 1e-14);
      EXPECT_NEAR(result.final.alpha[0], 0.5 + std::sin(6.0) / 4.4, 1e-9);
    }
  }
}

// The same once more: sliding of the third order.
TEST(Differentiator, OfTheSecondOrderFindsTwoDerivatives) {
  const Result result = simulate_text(R"toml(
[model]
name = "differentiator-2"
[states]
z0 = 0.1
z1 = 0
z2 = 0
[definitions]
e = "z0 - sin(t)"
[dynamics]
z0 = "-2*2^(1/3)*abs(e)^(2/3)*sign(e) + z1"
z1 = "-2.12*2^(2/3)*abs(e)^(1/3)*sign(e) + z2"
z2 = "-2.2*sign(e)"
[simulate]
until = 8
)toml",
                                      standard);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
  EXPECT_NEAR(result.final.x[0], std::sin(8.0), 1e-13);
  EXPECT_NEAR(result.final.x[1], std::cos(8.0), 1e-13);
  EXPECT_NEAR(result.final.x[2], -std::sin(8.0), 1e-11);
}

// The states of a pendulum with dry friction are known exactly behind the cycles; the friction, which the observer does
// not know, is its disturbance.
TEST(Differentiator, AnObserverKnowsTheStateOfItsPlant) {
  const auto plant = [](const std::string& observer, const std::string& states) {
    return fmt::format(R"toml(
[model]
name = "observer"
[states]
x = 1
v = 0
{}
[dynamics]
x = "v"
v = "-sin(x) - 0.2*v - 0.3*sign(v)"
{}
[simulate]
until = 8
)toml",
                       states, observer);
  };
  const std::string observer = "xh = \"vh + 2.6*sqrt(abs(x - xh))*sign(x - xh)\"\nvh = \"-sin(x) + 3.3*sign(x - xh)\"";
  const Result alone = simulate_text(plant("", ""), fine);
  for (const auto& accuracy : {standard, Accuracy{pipeline::Integrator::dop853, 1e-8, 1e-10}, fine}) {
    const Result result = simulate_text(plant(observer, "xh = 0\nvh = 0"), accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_TRUE(accumulation(result).has_value());
    EXPECT_NEAR(result.final.x[0], alone.final.x[0], 1e-6);
    EXPECT_NEAR(result.final.x[2], result.final.x[0], 1e-15);
    EXPECT_NEAR(result.final.x[3], result.final.x[1], 1e-15);
    // Beside the surface, where psi is rounding, no step may become so short that it changes nothing.
    EXPECT_LT(result.statistics.steps, 5000);
  }
}

// Two channels of super-twisting that influence each other: s1 passes 0 while s2 is held with its derivative.
TEST(Differentiator, ChannelsThatInfluenceEachOtherComeToRest) {
  std::vector<double> at_rest;
  for (const auto& accuracy : {fine, fine_explicit, standard}) {
    const Result result = simulate_text(R"toml(
[model]
name = "channels"
[states]
s1 = 1
s2 = -0.7
w1 = 0
w2 = 0
[dynamics]
s1 = "-1.5*sqrt(abs(s1))*sign(s1) + w1 + 0.2*s2"
s2 = "-1.5*sqrt(abs(s2))*sign(s2) + w2 - 0.3*s1"
w1 = "-1.1*sign(s1)"
w2 = "-1.3*sign(s2)"
[simulate]
until = 6
)toml",
                                        accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(result.final.mode, (std::vector<int>{0, 0}));
    for (const double x : result.final.x) EXPECT_NEAR(x, 0.0, 1e-12);
    at_rest.push_back(result.events.back().t);
  }
  EXPECT_NEAR(at_rest[1], at_rest[0], 1e-9);
  EXPECT_NEAR(at_rest[2], at_rest[0], 1e-5);
}

}  // namespace
}  // namespace saltus::problems
