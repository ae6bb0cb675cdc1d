// What a jump sets is made of values at the instant: a comparison there is what its operator says.
#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "run_model.hpp"
#include "saltus/event_integrator/mode/selections_at.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using model::Builder;
using model::Condition;
using model::JumpOptions;

/// One more state, which a jump sets to what is asked for.
struct Asked {
  Builder builder{"values"};
  SX x;
  std::vector<std::string> names;
  std::map<std::string, SX> set;

  void ask(const std::string& name, const SX& value) {
    builder.discrete_state("is_" + name, -7.0);
    names.push_back(name);
    set["is_" + name] = value;
  }
  void ask(const std::string& name, const Condition& condition) { ask(name, builder.if_(condition, 1.0, 0.0)); }
  /// Everything that compares e with 0.
  void ask_all(const SX& e) {
    ask("above", model::greater(e, 0.0));
    ask("not_below", model::greater_equal(e, 0.0));
    ask("below", model::less(e, 0.0));
    ask("not_above", model::less_equal(e, 0.0));
    ask("at", model::greater_equal(e, 0.0) && model::less_equal(e, 0.0));
    ask("beside", !(model::greater_equal(e, 0.0) && model::less_equal(e, 0.0)));
    ask("turned", model::greater(0.0, -2.0 * e));
    ask("sign", builder.sign(e));
    ask("step", builder.step(e));
    ask("abs", builder.abs(e));
    ask("max", builder.max(e, 0.0));
    ask("min", builder.min(e, 0.0));
    ask("inside", model::greater(builder.if_(model::greater(e, 0.0), 1.0, 0.0) - 0.25, 0.0));
  }
  std::vector<double> run(double until, ode::Method method) {
    IntegrationOptions options;
    options.method = method;
    options.until = until;
    const auto run = run_model(builder, options);
    EXPECT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    const auto first = run.final.x.size() - names.size();
    return {run.final.x.begin() + static_cast<std::ptrdiff_t>(first), run.final.x.end()};
  }
};

const std::vector<double> at_equality{0, 1, 0, 1, 1, 0, 0, 0, 0.5, 0, 0, 0, 0};
const std::vector<double> above{1, 1, 0, 0, 0, 1, 1, 1, 1, 2, 2, 0, 1};
const std::vector<double> below{0, 0, 1, 1, 0, 1, 0, -1, 0, 2, 0, -2, 0};

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << i;
}

/// x' = 1 from 0; jumps where x is `level`.
std::vector<double> at_a_root(double level, double compared, ode::Method method) {
  Asked asked;
  const SX x = asked.builder.state("x", {.initial = 0.0});
  asked.builder.dynamics("x", 1.0 + 0.0 * x);
  asked.ask_all(x - compared);
  asked.builder.jump(model::greater(x, level), asked.set);
  return asked.run(5.0, method);
}

TEST(JumpValues, AtTheRootThatTriggeredIsEqual) {
  for (const auto method : every_method) expect_near(at_a_root(3.0, 3.0, method), at_equality);
}

TEST(JumpValues, BesideTheirSurfacesHaveTheirSides) {
  for (const auto method : every_method) {
    expect_near(at_a_root(3.0, 1.0, method), above);
    expect_near(at_a_root(1.0, 3.0, method), below);
  }
}

TEST(JumpValues, AtGivenTimes) {
  Asked asked;
  const SX next = asked.builder.discrete_state("next", 2.1);
  asked.ask_all(asked.builder.time() - next);
  asked.builder.jump_at({2.1}, asked.set);
  expect_near(asked.run(3.0, ode::Method::dop853), at_equality);
}

TEST(JumpValues, AtTheStart) {
  Asked asked;
  const SX next = asked.builder.discrete_state("next", 0.0);
  asked.ask_all(asked.builder.time() - next);
  asked.builder.jump_at({0.0}, asked.set);
  expect_near(asked.run(3.0, ode::Method::dop853), at_equality);
}

TEST(JumpValues, WhereAnEarlierJumpHasPutThem) {
  Asked asked;
  const SX x = asked.builder.state("x", {.initial = 0.0});
  asked.builder.dynamics("x", 1.0 + 0.0 * x);
  asked.ask_all(x - 3.0);
  asked.builder.jump_at({1.0}, {{"x", SX(3.0)}}, {.priority = SX(1.0)});
  auto options = model::JumpOptions{};
  options.values = model::JumpValues::at_execution;
  asked.builder.jump_at({1.0}, asked.set, options);
  expect_near(asked.run(2.0, ode::Method::dop853), at_equality);
}

TEST(SelectionsAt, KeepWhatTheyHaveAtZero) {
  Builder builder("nested");
  const SX x = builder.state("x", {.initial = 1.0}), y = builder.state("y", {.initial = 0.0});
  builder.dynamics("x", builder.sign(x));
  builder.dynamics("y", builder.sign(y + builder.sign(x)));
  const auto system = builder.build();
  ASSERT_TRUE(system.has_value());
  const auto kernel = evaluation::ModelKernel::compile(*system);
  ASSERT_TRUE(kernel.has_value());
  const auto selections = [&](double at_x, double at_y, const std::vector<int>& zeros = {}) {
    const double point[] = {at_x, at_y};
    return selections_at(*kernel, 0.0, point, {0.25, 0.25}, zeros);
  };
  EXPECT_EQ(selections(2.0, -3.0), (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(selections(-2.0, 0.5), (std::vector<double>{0.0, 0.0}));  // the inner sign is read first
  EXPECT_EQ(selections(0.0, 2.0), (std::vector<double>{0.25, 1.0}));
  EXPECT_EQ(selections(-1e-9, 2.0, {0}), (std::vector<double>{0.25, 1.0}));
}

/// v slides on 0: it counts as equal, and its selection has the value of sliding.
TEST(JumpValues, OnWhatIsSlidOn) {
  Asked asked;
  const SX v = asked.builder.state("v", {.initial = 0.5});
  asked.builder.dynamics("v", 0.2 - asked.builder.sign(v));
  asked.ask("above", model::greater(v, 0.0));
  asked.ask("not_below", model::greater_equal(v, 0.0));
  asked.ask("not_above", model::less_equal(v, 0.0));
  asked.ask("friction", asked.builder.sign(v));
  asked.builder.jump_at({2.0}, asked.set);
  expect_near(asked.run(3.0, ode::Method::dop853), {0, 1, 1, 0.2});
}

/// How often a state has been counted up by jumps.
double count_every(double period, double from, double until, std::optional<double> begun = {}) {
  Builder builder("doses");
  const SX n = builder.discrete_state("n", 0.0);
  builder.jump_every(period, {{"n", n + 1.0}});
  IntegrationOptions options;
  options.from = from;
  options.until = until;
  options.begun = begun;
  return run_model(builder, options).final.x.front();
}

TEST(GivenTimes, PeriodsThatEndWithTheRunButForRoundingAreInIt) {
  for (const auto& [period, until, times] : {std::tuple(0.2, 1.2, 6.0),
                                             {0.1, 0.3, 3.0},
                                             {0.1, 1.7, 17.0},
                                             {0.05, 0.6, 12.0},
                                             {0.01, 0.35, 35.0},
                                             {1.0 / 3.0, 7.0 / 3.0, 7.0},
                                             {0.1, 0.29, 2.0},
                                             {0.1, 0.3 - 1e-12, 2.0}}) {
    EXPECT_EQ(count_every(period, 0.0, until), times) << period << " until " << until;
  }
  EXPECT_EQ(count_every(0.1, -1.0, -0.1), 9.0);
}

TEST(GivenTimes, ARunThatGoesOnKeepsThePhaseAndRepeatsNothing) {
  EXPECT_EQ(count_every(0.2, 0.5, 2.05, 0.0), 8.0);
  EXPECT_EQ(count_every(0.2, 1.2, 2.05, 0.0), 4.0);
  EXPECT_EQ(count_every(0.2, 0.5, 2.05), 7.0);
  for (const bool goes_on : {false, true}) {
    Builder builder("doses");
    const SX n = builder.discrete_state("n", 0.0), m = builder.discrete_state("m", 0.0);
    builder.jump_at({0.5, 1.0, 1.5}, {{"n", n + 1.0}});
    builder.jump(model::greater(n, -1.0), {{"m", m + 1.0}}, {.at_start = true});
    IntegrationOptions options;
    options.from = 1.0;
    options.until = 2.0;
    if (goes_on) options.begun = 0.0;
    EXPECT_EQ(run_model(builder, options).final.x, (goes_on ? std::vector{1.0, 0.0} : std::vector{2.0, 1.0}));
  }
}

/// Where something was changed between two runs: what a jump would have ended has not jumped.
TEST(GivenTimes, ARunThatGoesOnJumpsWhereTheConditionCannotHaveHeld) {
  for (const bool goes_on : {false, true}) {
    Builder builder("changed");
    const SX x = builder.state("x", {.initial = 4.0}), w = builder.discrete_state("w", 0.0),
             n = builder.discrete_state("n", 0.0);
    builder.dynamics("x", 1.0);
    builder.jump(model::greater(x, 2.0) && model::less(w, 0.5), {{"w", SX(1.0)}}, {.at_start = true});
    builder.jump(model::greater(x, 2.0), {{"n", n + 1.0}}, {.at_start = true});
    IntegrationOptions options;
    options.from = 1.0;
    options.until = 2.0;
    if (goes_on) options.begun = 0.0;
    EXPECT_EQ(run_model(builder, options).final.x, (std::vector{5.0, 1.0, goes_on ? 0.0 : 1.0}));
  }
}

/// What a sample every period has read of a state that is kicked at a time, with a larger priority.
TEST(GivenTimes, PrioritiesDecideWhereTimesAreTheSameButForRounding) {
  for (const auto& [period, kick] : {std::pair(0.3, 0.9), {0.1, 0.3}, {0.2, 0.6}, {0.7, 2.1}, {0.25, 0.75}}) {
    for (const double priority : {1.0, -1.0}) {
      Builder builder("sampled");
      const SX x = builder.discrete_state("x", 1.0);
      builder.discrete_state("y", 0.0);
      JumpOptions sample;
      sample.values = model::JumpValues::at_execution;
      builder.jump_every(period, {{"y", x}}, sample);
      builder.jump_at({kick}, {{"x", SX(5.0)}}, {.priority = SX(priority)});
      IntegrationOptions options;
      options.until = kick + 0.01;
      const auto run = run_model(builder, options);
      EXPECT_EQ(run.final.x, (std::vector{5.0, priority > 0.0 ? 5.0 : 1.0})) << period;
      EXPECT_EQ(run.events[run.events.size() - 1].t, kick);
      EXPECT_EQ(run.events[run.events.size() - 2].t, kick);
    }
  }
}

/// Seconds of the processor for each jump of n neurons, each of which jumps for itself.
double seconds_per_jump(int n) {
  Builder builder("neurons");
  for (int i = 0; i < n; ++i) {
    const std::string name = "v" + std::to_string(i);
    const SX v = builder.state(name, {.initial = i / (1.0 + n)});
    builder.dynamics(name, 1.2 - 0.1 * v);
    builder.jump(v - 1.0, model::Direction::up, {{name, SX(0.0)}});
  }
  const auto system = builder.build();
  auto kernel = evaluation::ModelKernel::compile(*system);
  IntegrationOptions options;
  options.until = 300.0 / n;
  double least = 1e9;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const std::clock_t begin = std::clock();
    const auto run = integrate(*kernel, options);
    least = std::min(least, static_cast<double>(std::clock() - begin) / static_cast<double>(run.events.size()));
  }
  return least / CLOCKS_PER_SEC;
}

TEST(CostOfAJump, GrowsLikeTheModelAndNotLikeItsSquare) {
  EXPECT_LT(seconds_per_jump(1200), 8.0 * seconds_per_jump(300));
}

}  // namespace
}  // namespace saltus::event_integrator::testing
