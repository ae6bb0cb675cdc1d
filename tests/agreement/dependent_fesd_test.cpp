// Surfaces whose gradients depend on each other, by finite elements: the same modes, events and doubts as the event
// engine has, and sensitivities through them.
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "agreement/networks.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::EventKind;
using result::Result;
using result::Termination;

Result by_elements(const Simulator& simulator, int steps) {
  auto options = simulator.options();
  options.method = pipeline::Method::fesd;
  options.fesd.steps = steps;
  return simulator.run(options);
}

std::vector<bool> missing(const std::vector<double>& values) {
  std::vector<bool> missing;
  for (const double value : values) missing.push_back(std::isnan(value));
  return missing;
}

/// Events of both engines, one by one.
void expect_same_events(const Result& exact, const Result& found, double tolerance, const std::string& what) {
  ASSERT_EQ(found.status.termination, Termination::completed) << what << ": " << found.status.message;
  ASSERT_EQ(found.events.size(), exact.events.size()) << what;
  for (std::size_t i = 0; i < exact.events.size(); ++i) {
    const Event& is = found.events[i];
    const Event& should = exact.events[i];
    EXPECT_NEAR(is.t, should.t, tolerance) << what;
    EXPECT_EQ(is.kind, should.kind) << what << " at " << should.t;
    EXPECT_EQ(is.surfaces, should.surfaces) << what << " at " << should.t;
    EXPECT_EQ(*is.mode_after, *should.mode_after) << what << " at " << should.t;
    EXPECT_EQ(is.unique, should.unique) << what << " at " << should.t;
    EXPECT_EQ(missing(*is.alpha_after), missing(*should.alpha_after)) << what << " at " << should.t;
  }
  EXPECT_EQ(found.final.mode, exact.final.mode) << what;
  EXPECT_EQ(missing(found.final.alpha), missing(exact.final.alpha)) << what;
}

/// The closed form of DependentSurfaces.ThreeAgentsMeetStayAndPart. Radau IIA with two stages is exact for the
/// velocities t, so that what is left is rounding.
TEST(DependentSurfacesByElements, ThreeAgentsMeetStayAndPart) {
  for (const double scale : {1.0, 1e8, 1e-8}) {
    const Simulator simulator = Simulator::from_text(three_agents("x1 = 0\nx2 = 1\nx3 = 3", "5", scale));
    const Result result = by_elements(simulator, 50);
    expect_same_events(simulator.run(with(simulator.options(), fine)), result, 1e-9, std::to_string(scale));
    ASSERT_EQ(result.events.size(), 3U);
    EXPECT_EQ(*result.events[1].mode_after, (std::vector<int>{0, 0, 0}));
    EXPECT_NEAR(result.events[2].t, 3.0, 1e-10);
    EXPECT_NEAR(result.final.x[0], 4.0 / 3.0 + 1.5 + 2.0, 1e-9);
    EXPECT_NEAR(result.final.x[2], 4.0 / 3.0 + 1.5 + 4.0, 1e-9);
  }
}

TEST(DependentSurfacesByElements, TheModelOfAgreementHasTheSameEvents) {
  const Simulator simulator = Simulator::from_catalogue("consensus");
  expect_same_events(simulator.run(with(simulator.options(), fine)), by_elements(simulator, 100), 1e-9, "consensus");
}

/// Elements of 1/67: errors of order h^3 (a twentieth of the sines' third derivatives, 2^3) are below 1e-6; events
/// are where velocities of 0.1 and more meet.
TEST(DependentSurfacesByElements, RandomNetworksHaveTheSameEvents) {
  std::mt19937_64 random(2027);
  int undetermined = 0;
  for (int instance = 0; instance < 24; ++instance) {
    const Simulator simulator = Simulator::from_text(agents_on_a_graph(instance, random));
    const Result exact = simulator.run(with(simulator.options(), fine));
    ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
    const Result found = by_elements(simulator, 400);
    expect_same_events(exact, found, 1e-4, std::to_string(instance));
    for (const Event& event : found.events) {
      for (const double alpha : *event.alpha_after) undetermined += std::isnan(alpha) ? 1 : 0;
    }
  }
  EXPECT_GT(undetermined, 20);
}

/// Selections of elements that nothing determines are not numbers, as in the rows.
TEST(DependentSurfacesByElements, ElementsHaveNoNumbersForWhatIsNotDetermined) {
  const Simulator simulator = Simulator::from_text(three_agents("x1 = 1\nx2 = 1\nx3 = 1", "2"));
  const Result result = by_elements(simulator, 10);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_TRUE(result.elements);
  ASSERT_FALSE(result.elements->selection.empty());
  for (const auto& row : result.elements->selection) EXPECT_EQ(missing(row), std::vector<bool>(3, true));
}

/// x3 is pushed by p t: the mean moves by p t^2/6, at 3/p the third one leaves. x1(T) = mean(0) + T - 3/(2p),
/// x3(T) = mean(0) + p T^2/2 - 2T + 3/p.
TEST(DependentSurfacesByElements, SensitivitiesFollowTheTimeOfParting) {
  std::string text = three_agents("x1 = 0\nx2 = 1\nx3 = 3", "5");
  text.replace(text.find("sign(s23) + t\""), 14, "sign(s23) + p*t\"");
  text.insert(text.find("[states]"), "[parameters]\np = 1\n");
  const Simulator simulator = Simulator::from_text(text);
  auto options = simulator.options();
  options.method = pipeline::Method::fesd;
  options.fesd.steps = 50;
  options.fesd.sensitivities = true;
  const Result result = simulator.run(options);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_TRUE(result.sensitivities);
  for (const auto& row : result.sensitivities->x0) {
    for (const double value : row) EXPECT_NEAR(value, 1.0 / 3.0, 1e-9);
  }
  const double behind = 5.0;
  EXPECT_NEAR(result.sensitivities->p[0][0], 1.5, 1e-9);
  EXPECT_NEAR(result.sensitivities->p[1][0], 1.5, 1e-9);
  EXPECT_NEAR(result.sensitivities->p[2][0], 0.5 * behind * behind - 3.0, 1e-9);
}

}  // namespace
}  // namespace saltus::problems
