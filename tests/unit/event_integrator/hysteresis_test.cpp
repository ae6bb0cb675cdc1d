// Hysteresis in the event engine: switches exactly at the thresholds, automata of several.
#include <cmath>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;

std::vector<double> switch_times(const Integration& run, const std::string& name) {
  std::vector<double> times;
  for (const auto& event : run.events) {
    if (event.kind == result::EventKind::jump && event.name == name) times.push_back(event.t);
  }
  return times;
}

TEST(Hysteresis, SwitchesAtItsThresholds) {
  model::Builder model("thermostat");
  const SX y = model.state("y", {15.0});
  const SX heating = model.hysteresis("heating", y, {.on = 18.0, .off = 20.0, .initial = 1.0});
  model.dynamics("y", -0.2 * y + 10.0 * heating);
  const auto run = run_tightly(model, 3.0);
  const auto times = switch_times(run, "heating");
  double t = 5.0 * std::log(35.0 / 30.0);
  const double cool = 5.0 * std::log(20.0 / 18.0), heat = 5.0 * std::log(32.0 / 30.0);
  std::vector<double> exact;
  for (int k = 0; t < 3.0; ++k) {
    exact.push_back(t);
    t += k % 2 == 0 ? cool : heat;
  }
  ASSERT_EQ(times.size(), exact.size());
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], exact[k], 1e-11);
  for (const auto& event : run.events) {
    EXPECT_NEAR(event.x[0], event.x[1] == 1.0 ? 20.0 : 18.0, 1e-11);
    EXPECT_EQ(event.x_after[1], 1.0 - event.x[1]);
  }
}

TEST(Hysteresis, OneThresholdIsTouchedAtTheStart) {
  model::Builder model("start");
  const SX y = model.state("y", {2.0});
  const SX h = model.hysteresis("h", y, {.on = 2.0, .off = 1.0});
  model.dynamics("y", 1.0 - 3.0 * h);
  const auto run = run_tightly(model, 0.75);  // on at once, then down to 1 after 1/2, then up
  EXPECT_EQ(switch_times(run, "h").size(), 2U);
  EXPECT_NEAR(switch_times(run, "h").at(0), 0.0, 1e-12);
  EXPECT_NEAR(switch_times(run, "h").at(1), 0.5, 1e-12);
  EXPECT_NEAR(run.final.x[0], 1.25, 1e-12);
}

/// Three of them over one input with nested thresholds: a stair, up at 1, 2, 3 and down at 0.5, 1.5, 2.5.
TEST(Hysteresis, NestedThresholdsAreAnAutomaton) {
  model::Builder model("stair");
  const SX y = model.state("y", {0.0}), direction = model.state("direction", {1.0});
  SX level = 0.0;
  for (int k = 1; k <= 3; ++k) {
    level += model.hysteresis("h" + std::to_string(k), y, {.on = double(k), .off = k - 0.5});
  }
  model.dynamics("y", direction);
  model.dynamics("direction", 0.0);
  model.jump(y - 3.25, model::Direction::up, {{"direction", -1.0}});
  model.output("level", level);
  const auto run = run_tightly(model, 6.5);
  std::vector<double> times;
  for (const auto& event : run.events) {
    if (event.name != "jump4") times.push_back(event.t);
  }
  const std::vector<double> exact{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  ASSERT_EQ(times.size(), exact.size());
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], exact[k], 1e-12);
  EXPECT_EQ(run.final.outputs.at(0), 0.0);
}

/// One input that jumps beyond both thresholds.
TEST(Hysteresis, FollowsJumpsOfItsInput) {
  model::Builder model("jumps");
  const SX y = model.state("y", {0.0});
  static_cast<void>(model.hysteresis("h", y, {.on = 1.0, .off = -1.0}));
  model.dynamics("y", 0.1);
  model.jump_at({1.0, 2.0}, {{"y", -5.0 * y}});
  const auto run = run_tightly(model, 3.0);
  EXPECT_EQ(run.status.termination, result::Termination::completed);
  EXPECT_EQ(switch_times(run, "h"), (std::vector<double>{2.0}));
}

}  // namespace
}  // namespace saltus::event_integrator::testing
