// Surfaces whose gradients depend on each other: networks of friction and of agents, flows of sums of absolute values.
// References are closed forms and the regularised engine.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "agreement/networks.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::EventKind;
using result::Result;
using result::Termination;

/// x' = (2, 0, -2 + t) from (0, 1, 3): the first two meet at t = 1/2 and go on at 1 together; the third one reaches
/// them where 3 - 2t + t^2/2 = 1/2 + t. All stay until the push on the third one, less its mean, is 2: t = 3.
TEST(DependentSurfaces, ThreeAgentsMeetStayAndPart) {
  const double meet = 3.0 - std::sqrt(4.0), part = 3.0;
  for (const double scale : {1.0, 1e8, 1e-8}) {
    const std::string text = three_agents("x1 = 0\nx2 = 1\nx3 = 3", "5", scale);
    for (const auto& accuracy : {fine, fine_explicit, fine_implicit, standard}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      const auto events = switches_of(result);
      ASSERT_EQ(events.size(), 3U);
      EXPECT_NEAR(events[0].t, 0.5, 1e-12);
      EXPECT_NEAR(events[1].t, meet, 1e-10);
      EXPECT_EQ(events[1].kind, EventKind::enter_sliding);
      EXPECT_EQ(events[1].surfaces, (std::vector<std::string>{"s13", "s23"}));
      EXPECT_EQ(*events[1].mode_after, (std::vector<int>{0, 0, 0}));
      EXPECT_EQ(events[1].unique, true);
      // Two conditions for three selections.
      for (const double alpha : *events[1].alpha_after) EXPECT_TRUE(std::isnan(alpha));
      EXPECT_NEAR(events[2].t, part, 1e-9);
      EXPECT_EQ(events[2].kind, EventKind::leave_sliding);
      EXPECT_EQ(*events[2].mode_after, (std::vector<int>{0, -1, -1}));
      EXPECT_NEAR((*events[2].alpha_after)[0], 0.5, 1e-9);
      // The mean moves by t^2/6; behind the parting the pair moves at 1, the third one at t - 2.
      const double mean = 4.0 / 3.0 + part * part / 6.0;
      EXPECT_NEAR(events[2].x[0], mean, 1e-8);
      EXPECT_NEAR(result.final.x[0], mean + 2.0, 1e-8);
      EXPECT_EQ(result.final.x[0], result.final.x[1]);
      EXPECT_NEAR(result.final.x[2], mean + 4.0, 1e-8);
    }
  }
}

TEST(DependentSurfaces, TheModelOfAgreementPartsInTime) {
  const Simulator simulator = Simulator::from_catalogue("consensus");
  const Result result = simulator.run(with(simulator.options(), fine));
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const auto events = switches_of(result);
  ASSERT_EQ(events.size(), 4U);
  EXPECT_EQ(*events[2].mode_after, std::vector<int>(6, 0));
  EXPECT_NEAR(events[3].t, 8.0, 1e-10);
  for (const double x : events[3].x) EXPECT_NEAR(x, 4.75, 1e-10);
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    EXPECT_NEAR(result.final.x[i], 6.75, 1e-10);
  }
  EXPECT_NEAR(result.final.x[3], 7.75, 1e-10);
}

TEST(DependentSurfaces, AStartWhereAllMeetIsHeld) {
  const Result result = simulate_text(three_agents("x1 = 1\nx2 = 1\nx3 = 1", "4"), standard);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(*result.events.front().mode_after, (std::vector<int>{0, 0, 0}));
  EXPECT_NEAR(result.events.back().t, 3.0, 1e-9);
  EXPECT_NEAR(result.final.x[2] - result.final.x[0], 0.5, 1e-8);
}

/// Kinks of drag and of an output at the same place, which do not hold anything: x = 0 is passed by all three together.
TEST(DependentSurfaces, KinksArePassedWhileAllAreHeld) {
  const std::string text = R"toml(
[model]
name = "three agents with drag"
[states]
x1 = -1
x2 = -1
x3 = -1
[dynamics]
x1 = "sign(x2 - x1) + sign(x3 - x1) + 1 - 0.5*abs(x1)"
x2 = "sign(x1 - x2) + sign(x3 - x2) + 1 - 0.5*abs(x2)"
x3 = "sign(x1 - x3) + sign(x2 - x3) + 1 - 0.5*abs(x3)"
[outputs]
spread = "abs(x1 - 2*x2 + x3) + abs(x2)"
[simulate]
until = 4
)toml";
  const Result result = simulate_text(text, fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.mode, (std::vector<int>{0, 0, 0}));
  // x' = 1 + x/2 until x = 0 at 2 log 2, then x' = 1 - x/2.
  const double x = 2.0 * (1.0 - std::exp(-0.5 * (4.0 - 2.0 * std::log(2.0))));
  for (const double found : result.final.x) EXPECT_NEAR(found, x, 1e-10);
}

/// Where all meet, a mode that does not hold all of them must lead away.
TEST(DependentSurfaces, AModeThatIsForcedIsChecked) {
  const std::string text = three_agents("x1 = 1\nx2 = 1\nx3 = 1", "4") + "[simulate.initial_mode]\n";
  const Result held = simulate_text(text + "s12 = 0\ns13 = 0\ns23 = 0\n", standard);
  ASSERT_EQ(held.status.termination, Termination::completed) << held.status.message;
  EXPECT_NEAR(held.events.back().t, 3.0, 1e-9);
  const Result parted = simulate_text(text + "s12 = 0\ns13 = -1\ns23 = -1\n", standard);
  EXPECT_EQ(parted.status.termination, Termination::no_admissible_mode) << parted.status.message;
}

/// Two blocks on the ground (friction 1/2 each) and on each other (friction 1); the first one is pushed by t. At t = 1
/// both start to move together, at t = 2 they part.
TEST(DependentSurfaces, TwoBlocksStickToTheGroundAndToEachOther) {
  const std::string text = R"toml(
[model]
name = "two blocks"
[states]
v1 = 0.1
v2 = -0.2
[dynamics]
v1 = "t - 0.5*sign(v1) - sign(v1 - v2)"
v2 = "sign(v1 - v2) - 0.5*sign(v2)"
[simulate]
until = 3
)toml";
  const Result result = simulate_text(text, fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const auto events = switches_of(result);
  std::vector<double> times;
  for (const Event& event : events) times.push_back(event.t);
  ASSERT_GE(times.size(), 3U);
  EXPECT_NEAR(times[times.size() - 2], 1.0, 1e-9);
  EXPECT_NEAR(times.back(), 2.0, 1e-9);
  EXPECT_EQ(*events[events.size() - 3].mode_after, (std::vector<int>{0, 0, 0}));
  // Together (t - 1)^2/4, then t - 3/2 and 1/2.
  EXPECT_NEAR(result.final.x[0], 0.25 + 1.0, 1e-8);
  EXPECT_NEAR(result.final.x[1], 0.25 + 0.5, 1e-8);
}

/// min |x1 - 1| + |x2 - 1| + |x1 + x2 - 2|: three surfaces through one point of the plane.
TEST(DependentSurfaces, AMinimumWhereThreeAbsoluteValuesVanishIsReached) {
  const std::string text = R"toml(
[model]
name = "least absolute deviations"
[states]
x1 = 3
x2 = -1.5
[dynamics]
x1 = "-sign(x1 - 1) - sign(x1 + x2 - 2)"
x2 = "-sign(x2 - 1) - sign(x1 + x2 - 2)"
[simulate]
until = 10
)toml";
  const Result result = simulate_text(text, fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.final.x[0], 1.0, 1e-12);
  EXPECT_NEAR(result.final.x[1], 1.0, 1e-12);
  EXPECT_EQ(result.events.back().unique, true);
}

/// Selections that nothing determines move the state: x_i' = sign of what the neighbours are ahead.
TEST(DependentSurfaces, AMotionThatIsNotDeterminedIsRefused) {
  const std::string text = R"toml(
[model]
name = "drift"
[states]
x1 = 1
x2 = 0
x3 = -0.5
[dynamics]
x1 = "sign(x2 - x1)"
x2 = "sign(x1 + x3 - 2*x2)"
x3 = "sign(x2 - x3)"
[simulate]
until = 3
)toml";
  const Result result = simulate_text(text, fine);
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  EXPECT_NE(result.status.message.find("depend on each other"), std::string::npos) << result.status.message;
}

/// All differences of twelve states: refused at once, with their number as the reason.
TEST(DependentSurfaces, TooManyAreRefusedAtOnce) {
  std::string states, dynamics;
  for (int i = 0; i < 12; ++i) {
    states += fmt::format("x{} = 0\n", i);
    std::string sum;
    for (int j = 0; j < 12; ++j) {
      if (j != i) sum += fmt::format(" + sign(x{} - x{})", j, i);
    }
    dynamics += fmt::format("x{} = \"0{}\"\n", i, sum);
  }
  const Result result = simulate_text(
      fmt::format("[model]\nname = \"many\"\n[states]\n{}[dynamics]\n{}[simulate]\nuntil = 20\n", states, dynamics),
      standard);
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  EXPECT_NE(result.status.message.find("too many"), std::string::npos) << result.status.message;
}

/// Four absolute values pull, two sines push. The solution drifts through the edge of a layer so slowly that velocities
/// on both sides of it are rounding; nothing slides on it all the same.
TEST(DependentSurfaces, LayersAreLeftAndEnteredHoweverSlowly) {
  const std::string text = R"toml(
[model]
name = "flow"
[states]
x0 = 0.58
x1 = 0.88
[switching]
s1 = "0.85*x0 + 0.65*x1"
s2 = "-0.87*x0 + 0.19*x1"
s3 = "0.74*x0 + 0.7*x1"
s4 = "0.26*x0 + 0.66*x1"
[dynamics]
x0 = "-1.0115*sign(s1) + 1.0179*sign(s2) - 0.7918*sign(s3) - 0.0832*sign(s4) + 2.97*sin(0.85*t+5.09)"
x1 = "-0.7735*sign(s1) - 0.2223*sign(s2) - 0.749*sign(s3) - 0.2112*sign(s4) + 2.91*sin(0.84*t+2.14)"
[simulate]
until = 4
)toml";
  const Simulator simulator = Simulator::from_text(text);
  const Result exact = simulator.run(with(simulator.options(), standard));
  auto options = simulator.options();
  options.method = pipeline::Method::smoothed;
  options.smoothed.epsilon = 1e-7;
  const Result smooth = simulator.run(options);
  ASSERT_EQ(smooth.status.termination, Termination::completed) << smooth.status.message;
  // A few layers, as for the networks.
  for (std::size_t i = 0; i < exact.final.x.size(); ++i) EXPECT_NEAR(exact.final.x[i], smooth.final.x[i], 1e-5);
}

/// Agents on a random graph, each pushed by a sine, against layers of width 1e-7.
TEST(DependentSurfaces, RandomNetworksAgreeWithLayers) {
  std::mt19937_64 random(2026);
  int held = 0, compared = 0;
  for (int instance = 0; instance < 40; ++instance) {
    const Simulator simulator = Simulator::from_text(agents_on_a_graph(instance, random));
    const Result exact = simulator.run(with(simulator.options(), standard));
    ASSERT_EQ(exact.status.termination, Termination::completed) << instance << ": " << exact.status.message;
    for (const Event& event : exact.events) {
      for (const double alpha : *event.alpha_after) held += std::isnan(alpha) ? 1 : 0;
    }
    auto options = simulator.options();
    options.method = pipeline::Method::smoothed;
    options.smoothed.epsilon = 1e-7;
    const Result smooth = simulator.run(options);
    if (smooth.status.termination != Termination::completed) continue;
    ++compared;
    for (std::size_t i = 0; i < exact.final.x.size(); ++i) {
      EXPECT_NEAR(exact.final.x[i], smooth.final.x[i], 1e-5) << instance;
    }
  }
  EXPECT_GT(held, 20);
  EXPECT_GT(compared, 30);
}

}  // namespace
}  // namespace saltus::problems
