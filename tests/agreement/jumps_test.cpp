// [[jumps]] against closed forms: triggers, order of execution, the mode behind.
#include "agreement/jumps.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace saltus::problems {
namespace {

// T' = -0.1 (T - 18) + 2 on between 22 and 23.5: heating and cooling are exponentials.
TEST(Jumps, ThermostatWithHysteresis) {
  const Result result = simulated(R"toml(
[states]
T = 15
on = 1
[dynamics]
T = "-0.1*(T - 18) + 2*on"
on = "0"
[[jumps]]
name = "cool"
when = "T > 23.5"
set = { on = "0" }
[[jumps]]
name = "heat"
when = "T < 22"
set = { on = "1" }
[simulate]
until = 12
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const double first = 10 * std::log(23 / 14.5);
  const double cooling = 10 * std::log(5.5 / 4);
  const double heating = 10 * std::log(16 / 14.5);
  expect_times(jumps_of(result), {first, first + cooling, first + cooling + heating, first + 2 * cooling + heating},
               1e-11);
  EXPECT_EQ(result.events[0].name, "cool");
  EXPECT_EQ(result.events[0].surfaces, std::vector<std::string>{"cool"});
  EXPECT_NEAR(result.events[0].x[0], 23.5, 1e-12);
  EXPECT_EQ(result.events[0].x_after[1], 0.0);
}

// Falls from 10, keeps 9/10 of its speed: impacts at t1, t1 + 2 e t1, t1 + 2 (e + e^2) t1, …
TEST(Jumps, BouncingBallMeetsEveryImpact) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(ball("0.9", 26), accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    std::vector<double> times{10.0 / 7.0};
    for (double e = 0.9; times.back() + e * 20.0 / 7.0 < 26; e *= 0.9) times.push_back(times.back() + e * 20.0 / 7.0);
    expect_times(jumps_of(result, "bounce"), times, 1e-11);
    EXPECT_NEAR(result.events[3].x_after[1], 14 * std::pow(0.9, 4), 1e-11);
  }
}

// x' = -k x^2 t: 1/x = 1/x0 + k t^2/2.
TEST(Jumps, JumpOfTheStateItself) {
  const Result result = simulated(R"toml(
[parameters]
k = 0.7
c = 0.4
v = 0.3
[states]
x = 1
[dynamics]
x = "-k*x^2*t"
[[jumps]]
when = "x"
direction = "down"
set = { x = "x + v" }
[[jumps]]
name = "at_c"
when = "x < c"
set = { x = "x + v" }
[simulate]
until = 2.5
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const double t = std::sqrt(2 * (1 - 0.4) / (0.7 * 0.4));
  expect_times(jumps_of(result), {t}, 1e-11);
  EXPECT_NEAR(result.final.x[0], 1 / (1 / 0.7 + 0.35 * (2.5 * 2.5 - t * t)), 1e-11);
}

// Integrate and fire with a refractory time: v' = 2 - v from 0 to 1 takes ln 2, then 0.3 of silence.
TEST(Jumps, IntegrateAndFire) {
  const Result result = simulated(R"toml(
[states]
v = 0
silent = 0
spikes = 0
[dynamics]
v = "(1 - silent)*(2 - v)"
silent = "0"
spikes = "0"
[[jumps]]
name = "spike"
when = "v - 1"
direction = "up"
set = { v = "0", silent = "1", spikes = "spikes + 1" }
[[jumps]]
name = "wake"
when = "silent > 0"
delay = 0.3
set = { silent = "0" }
[simulate]
until = 5
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const double ln2 = std::log(2.0);
  expect_times(jumps_of(result, "spike"), {ln2, 2 * ln2 + 0.3, 3 * ln2 + 0.6, 4 * ln2 + 0.9, 5 * ln2 + 1.2}, 1e-11);
  // A delay is added to the time of the trigger, nothing else.
  EXPECT_EQ(jumps_of(result, "wake")[0].t, jumps_of(result, "spike")[0].t + 0.3);
  EXPECT_EQ(result.final.x[2], 5.0);
}

TEST(Jumps, TimesAreHitExactly) {
  const Result result = simulated(std::string(counter) + R"toml(
[[jumps]]
name = "tick"
every = 0.1
set = { n = "n + 1" }
[[jumps]]
name = "given"
at = [1, 2.5, 2.7]
set = { a = "x" }
[simulate]
from = 0.7
until = 2.7
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const auto ticks = jumps_of(result, "tick");
  ASSERT_GE(ticks.size(), 19U);
  for (std::size_t k = 0; k < ticks.size(); ++k) EXPECT_EQ(ticks[k].t, 0.7 + static_cast<double>(k + 1) * 0.1);
  const auto given = jumps_of(result, "given");
  ASSERT_EQ(given.size(), 3U);
  EXPECT_EQ(given[0].t, 1.0);
  EXPECT_EQ(given[1].t, 2.5);
  EXPECT_EQ(given[2].t, 2.7);  // at the end, too
  EXPECT_NEAR(result.final.x[2], 2.0, 1e-14);
}

// c' = -k c, a dose of 1 every tau: behind n doses c = (1 - q^n)/(1 - q), q = exp(-k tau).
TEST(Jumps, Dosing) {
  const Result result = simulated(R"toml(
[states]
c = 0
[dynamics]
c = "-0.3*c"
[[jumps]]
every = 2
set = { c = "c + 1" }
[simulate]
until = 20
)toml");
  const double q = std::exp(-0.6);
  EXPECT_NEAR(result.final.x[0], (1 - std::pow(q, 10)) / (1 - q), 1e-11);
  EXPECT_EQ(result.events.size(), 10U);
}

TEST(Jumps, CascadesRunAtOneTimeByPriority) {
  const Result result = simulated(std::string(counter) + R"toml(
[[jumps]]
name = "low"
when = "x > 1"
set = { n = "10*n + 1" }
[[jumps]]
name = "high"
when = "x > 1"
priority = 2
set = { n = "10*n + 2" }
[[jumps]]
name = "third"
when = "n > 20"
priority = "a + 3"
set = { n = "10*n + 3" }
[simulate]
until = 2
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  // high: 2, low would be next: values were taken at the trigger, so it sets 1; then nothing is above 20.
  const auto jumps = jumps_of(result);
  ASSERT_EQ(jumps.size(), 2U);
  EXPECT_EQ(jumps[0].name, "high");
  EXPECT_EQ(jumps[1].name, "low");
  EXPECT_EQ(result.final.x[1], 1.0);
  EXPECT_EQ(jumps[0].t, jumps[1].t);
  EXPECT_NEAR(jumps[0].t, 1.0, 1e-14);
  // Rows: one before all of them, one behind.
  long rows = 0;
  for (const double t : result.trajectory.t) rows += t == jumps[0].t ? 1 : 0;
  EXPECT_EQ(rows, 2);
}

TEST(Jumps, ValuesAtExecutionSeeWhatHappenedBefore) {
  const Result result = simulated(std::string(counter) + R"toml(
[[jumps]]
name = "first"
when = "x > 1"
values = "execution"
set = { n = "10*n + 1" }
[[jumps]]
name = "second"
when = "x > 1"
values = "execution"
set = { n = "10*n + 2" }
[[jumps]]
name = "third"
when = "n > 11"
values = "execution"
set = { n = "10*n + 3" }
[simulate]
until = 2
)toml");
  EXPECT_EQ(jumps_of(result).size(), 3U);
  EXPECT_EQ(result.final.x[1], 123.0);
}

TEST(Jumps, DelaysQueueAndConditionsMayDropThem) {
  const std::string text = std::string(counter) + R"toml(
[[jumps]]
name = "kept"
when = "sin(2*pi*x) > 0"
delay = 0.75
set = { n = "n + 1" }
values = "execution"
[[jumps]]
name = "dropped"
when = "sin(2*pi*x) > 0"
delay = 0.75
persistent = false
set = { a = "a + 1" }
[[jumps]]
name = "in_time"
when = "sin(2*pi*x) > 0"
delay = 0.25
persistent = false
values = "execution"
set = { a = "a + 10" }
[simulate]
until = 3.9
)toml";
  const Result result = simulated(text);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  // True from 0, 1, 2, 3 on (at 0 by moving on), false from 0.5, 1.5, …
  expect_times(jumps_of(result, "kept"), {0.75, 1.75, 2.75, 3.75}, 1e-11);
  expect_times(jumps_of(result, "in_time"), {0.25, 1.25, 2.25, 3.25}, 1e-11);
  EXPECT_TRUE(jumps_of(result, "dropped").empty());
  EXPECT_EQ(result.final.x[2], 40.0);
}

TEST(Jumps, ConditionsThatHoldAtTheStart) {
  const std::string head = std::string(counter) + "[[jumps]]\nwhen = \"x < 1\"\nset = { n = \"n + 1\" }\n";
  const std::string tail = "[simulate]\nuntil = 2\n";
  EXPECT_EQ(simulated(head + tail).events.size(), 0U);
  const Result at_start = simulated(head + "at_start = true\n" + tail);
  ASSERT_EQ(at_start.events.size(), 1U);
  EXPECT_EQ(at_start.events[0].t, 0.0);
  EXPECT_FALSE(at_start.events[0].mode_before.has_value());
  EXPECT_EQ(at_start.trajectory.x.front()[1], 1.0);  // the first row is the state behind
}

TEST(Jumps, AGuardAtZeroAtTheStartIsNotYetCrossed) {
  const std::string tail = "set = { n = \"n + 1\" }\n[simulate]\nuntil = 2\n";
  const Result up = simulated(std::string(counter) + "[[jumps]]\nwhen = \"x\"\ndirection = \"up\"\n" + tail);
  ASSERT_EQ(up.events.size(), 1U);
  EXPECT_EQ(up.events[0].t, 0.0);
  EXPECT_TRUE(
      simulated(std::string(counter) + "[[jumps]]\nwhen = \"x\"\ndirection = \"down\"\n" + tail).events.empty());
}

TEST(Jumps, EndlessCascadesAreStoppedAndNamed) {
  const Result result = simulated(std::string(counter) + R"toml(
[[jumps]]
name = "ping"
when = "n < 1 and x > 1"
set = { n = "1" }
[[jumps]]
name = "pong"
when = "n > 0.5"
set = { n = "0" }
[simulate]
until = 2
)toml");
  EXPECT_EQ(result.status.termination, Termination::iteration_limit);
  EXPECT_NE(result.status.message.find("'ping'"), std::string::npos) << result.status.message;
  EXPECT_NE(result.status.message.find("'pong'"), std::string::npos) << result.status.message;
  EXPECT_NEAR(result.status.time_reached, 1.0, 1e-12);
}

// x slides on 0 from t = 1; a jump at 2 lifts it to 1, from where it falls again; another puts it onto 0 at once.
TEST(Jumps, OffASurfaceAndOntoIt) {
  const Result result = simulated(R"toml(
[states]
x = -1
[dynamics]
x = "-sign(x)"
[[jumps]]
name = "lift"
at = [2]
set = { x = "x + 1" }
[[jumps]]
name = "drop"
at = [2.5]
set = { x = "0" }
[simulate]
until = 4
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 3U);
  EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
  EXPECT_EQ(result.events[1].kind, EventKind::jump);
  EXPECT_EQ(result.events[1].mode_before, (result::Mode{0}));
  EXPECT_EQ(result.events[1].mode_after, (result::Mode{1}));
  EXPECT_EQ(result.events[2].mode_before, (result::Mode{1}));
  EXPECT_EQ(result.events[2].mode_after, (result::Mode{0}));
  EXPECT_EQ(result.events[2].alpha_after->front(), 0.5);
  EXPECT_NEAR(result.events[2].x[0], 0.5, 1e-13);
  EXPECT_EQ(result.final.x[0], 0.0);
}

// A comparison of discrete states beside a sliding surface: slides while phase is 1, leaves with the jump at 3.
TEST(Jumps, ADiscreteStateChoosesTheField) {
  const Result result = simulated(R"toml(
[states]
x = -1
phase = 1
[dynamics]
x = "if(phase < 1.5, -sign(x), 1)"
phase = "0"
[[jumps]]
at = [3]
set = { phase = "2" }
[simulate]
until = 4
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
  EXPECT_EQ(result.events[0].surfaces, std::vector<std::string>{"x"});
  EXPECT_NEAR(result.events[0].t, 1.0, 1e-13);
  EXPECT_EQ(result.events[1].kind, EventKind::jump);
  EXPECT_EQ(result.events[1].x_after[0], 0.0);
  EXPECT_NEAR(result.final.x[0], 1.0, 1e-13);
}

// The jump happens where psi itself is 0: one entry, and the mode behind it is that of the motion.
TEST(Jumps, AGuardThatIsASwitchingFunction) {
  const Result result = simulated(R"toml(
[states]
x = 1
n = 0
[dynamics]
x = "-2 + sign(x)"
n = "0"
[[jumps]]
when = "x"
direction = "down"
set = { n = "n + 1" }
[simulate]
until = 2
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_NEAR(result.events[0].t, 1.0, 1e-14);
  EXPECT_EQ(result.events[0].mode_before, (result::Mode{1}));
  EXPECT_EQ(result.events[0].mode_after, (result::Mode{-1}));
  EXPECT_NEAR(result.final.x[0], -3.0, 1e-13);
}

TEST(Jumps, UserEventsByMotionAndByJumps) {
  const Result result = simulated(R"toml(
[states]
x = 0
[dynamics]
x = "1"
[[jumps]]
when = "x > 1"
set = { x = "0" }
[[events]]
name = "full"
when = "x - 1"
direction = "up"
[[events]]
name = "half"
when = "x - 0.5"
direction = "down"
[simulate]
until = 2.25
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  std::vector<std::string> names;
  for (const auto& event : result.events) names.push_back(*event.name);
  EXPECT_EQ(names, (std::vector<std::string>{"full", "jump1", "half", "full", "jump1", "half"}));
  EXPECT_NEAR(result.events[0].x_after[0], 1.0, 1e-13);
  EXPECT_NEAR(result.events[2].x[0], 1.0, 1e-13);
  EXPECT_EQ(result.events[2].x_after[0], 0.0);
}

TEST(Jumps, AStopLetsTheJumpOfItsTimeHappen) {
  const Result result = simulated(R"toml(
[states]
x = 0
[dynamics]
x = "1"
[[jumps]]
when = "x > 1"
set = { x = "-3" }
[[events]]
name = "full"
when = "x > 1"
stop = true
[simulate]
until = 3
)toml");
  EXPECT_EQ(result.status.termination, Termination::stopped_by_event);
  EXPECT_EQ(jumps_of(result).size(), 1U);
  EXPECT_EQ(result.final.x[0], -3.0);
  EXPECT_NEAR(result.final.t, 1.0, 1e-14);
}

TEST(Jumps, WhatCannotBeEvaluatedIsSaid) {
  const auto status = [](const std::string& line) {
    return simulated(std::string(counter) + "[[jumps]]\nname = \"bad\"\nwhen = \"x > 1\"\n" + line +
                     "\n[simulate]\nuntil = 2\n")
        .status;
  };
  const auto infinite = status("set = { a = \"1/n\" }");
  EXPECT_EQ(infinite.termination, Termination::evaluation_failed);
  EXPECT_NE(infinite.message.find("'bad' sets a"), std::string::npos) << infinite.message;
  const auto negative = status("set = { a = \"1\" }\ndelay = \"-x\"");
  EXPECT_EQ(negative.termination, Termination::evaluation_failed);
  EXPECT_NE(negative.message.find("delay"), std::string::npos) << negative.message;
}

TEST(Jumps, TheOutputGridChangesNoBit) {
  const Simulator model = Simulator::from_text(R"toml([model]
name = "jumps"
[states]
y = 1
v = 0
n = 0
[dynamics]
y = "v"
v = "-9.81 - 0.1*v*abs(v) - 0.5*sign(v)"
n = "0"
[[jumps]]
when = "y"
direction = "down"
set = { v = "-0.8*v", n = "n + 1" }
[[jumps]]
every = 0.37
set = { v = "v + 1" }
[simulate]
until = 3
)toml");
  for (const Accuracy& accuracy : {standard, fine, implicit}) {
    auto options = with(model.options(), accuracy);
    options.output = pipeline::EveryStep{};
    const Result steps = model.run(options);
    ASSERT_EQ(steps.status.termination, Termination::completed) << steps.status.message;
    EXPECT_GT(steps.events.size(), 10U);
    for (const pipeline::OutputGrid& grid :
         {pipeline::OutputGrid{pipeline::NumberOfPoints{2}}, pipeline::OutputGrid{pipeline::NumberOfPoints{1237}},
          pipeline::OutputGrid{pipeline::EveryInterval{0.37}}}) {
      options.output = grid;
      const Result other = model.run(options);
      ASSERT_EQ(other.events.size(), steps.events.size());
      for (std::size_t i = 0; i < steps.events.size(); ++i) {
        EXPECT_EQ(other.events[i].t, steps.events[i].t);
        EXPECT_EQ(other.events[i].x_after, steps.events[i].x_after);
      }
      EXPECT_EQ(other.final.x, steps.final.x);
    }
  }
}

}  // namespace
}  // namespace saltus::problems
