// Runs through cells: every break is passed exactly once, and closed forms come out to rounding.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Termination;

struct Settings {
  double from = 0.0, until = 1.0;
  ode::Method method = ode::Method::dop853;
  double rtol = 1e-11;
  std::vector<double> times{};
  std::optional<double> max_step{};
};

Integration run(Builder& builder, const Settings& settings) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  auto kernel = evaluation::ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.method = settings.method;
  options.tolerances = {settings.rtol, settings.rtol / 100};
  options.from = settings.from;
  options.until = settings.until;
  options.max_step = settings.max_step;
  if (!settings.times.empty()) options.output = {OutputTimes::Rows::at_times, settings.times};
  auto result = integrate(*kernel, options);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  return result;
}

double sawtooth_integral(double t, double period) {
  const double n = std::floor(t / period), rest = t - n * period;
  return n * period * period / 2 + rest * rest / 2;
}

TEST(CellRuns, SawtoothBeforeAndBehindZero) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    Builder model("saw");
    const SX t = model.time();
    static_cast<void>(model.state("x", {0}));
    model.dynamics("x", model.mod(t, 0.3));
    const auto result = run(model, {.from = -1.0, .until = 1.1, .method = method});
    EXPECT_NEAR(result.final.x[0], sawtooth_integral(1.1, 0.3) - sawtooth_integral(-1.0, 0.3), 1e-13);
    EXPECT_TRUE(result.events.empty());
  }
}

TEST(CellRuns, EveryPeriodIsFoundExactlyOnce) {
  Builder model("samples");
  const SX t = model.time();
  static_cast<void>(model.state("x", {0}));
  model.dynamics("x", model.floor(t / 0.1));
  const double samples = 1e5;
  const auto result = run(model, {.until = samples * 0.1, .method = ode::Method::dopri5, .rtol = 1e-9});
  // 0.1 (0 + 1 + … + (n-1)): a period too many or too few would change it by 1e-5 of its value.
  EXPECT_NEAR(result.final.x[0] / (0.1 * samples * (samples - 1) / 2), 1.0, 1e-10);
  EXPECT_LE(result.statistics.steps, 3 * static_cast<long>(samples));
}

TEST(CellRuns, LinearPartsOfSeriesChangeWithTheCell) {
  // x' = -(1 + floor(t)) x: in every cell another matrix, which is found by operations to be one.
  for (const auto method : {ode::Method::dop853, ode::Method::taylor}) {
    Builder model("stairs");
    const SX t = model.time(), x = model.state("x", {1.0});
    model.dynamics("x", -(1.0 + model.floor(t)) * x);
    const auto result = run(model, {.until = 3.5, .method = method});
    EXPECT_NEAR(result.final.x[0], std::exp(-(1.0 + 2.0 + 3.0 + 0.5 * 4.0)), 1e-12) << static_cast<int>(method);
  }
}

TEST(CellRuns, PulseWidthModulation) {
  // x' = -x + 1 during the first d of every period T.
  const double T = 0.5, d = 0.2;
  Builder model("pwm");
  const SX t = model.time(), x = model.state("x", {0});
  model.dynamics("x", -x + model.step(d - model.mod(t, T)));
  const auto result = run(model, {.until = 20 * T});
  double exact = 0.0;
  for (int k = 0; k < 20; ++k) {
    exact = 1 + (exact - 1) * std::exp(-d);
    exact *= std::exp(-(T - d));
  }
  EXPECT_NEAR(result.final.x[0], exact, 1e-12);
  EXPECT_TRUE(result.events.empty());  // of time only
}

TEST(CellRuns, ZeroOrderHold) {
  const double T = 0.1;
  Builder model("hold");
  const SX t = model.time(), x = model.state("x", {1});
  const SX u = cos(T * model.floor(t / T));
  model.dynamics("x", u - 2 * x);
  model.output("u", u);
  std::vector<double> times;
  for (int k = 0; k <= 50; ++k) times.push_back(k * T);
  const auto result = run(model, {.until = 50 * T, .times = times});
  double exact = 1.0;
  ASSERT_EQ(result.trajectory.t, times);
  for (int k = 0; k <= 50; ++k) {
    EXPECT_NEAR(result.trajectory.x[static_cast<std::size_t>(k)][0], exact, 1e-12);
    // At a sampling time the value is the new one, however the time was rounded.
    if (k < 50) {
      EXPECT_NEAR(result.trajectory.outputs[static_cast<std::size_t>(k)][0], std::cos(k * T), 1e-12) << k;
    }
    const double held = std::cos(k * T) / 2;
    exact = held + (exact - held) * std::exp(-2 * T);
  }
}

TEST(CellRuns, CellsInsideCells) {
  Builder model("nested");
  const SX t = model.time();
  static_cast<void>(model.state("x", {0}));
  model.dynamics("x", model.floor(3 * model.mod(t, 2)));
  // 0 + 1 + … + 5, a third each, per period.
  EXPECT_NEAR(run(model, {.until = 8}).final.x[0], 4 * 5.0, 1e-13);
}

TEST(CellRuns, ComparisonsOfWholePartsHoldAsWritten) {
  // Equal for a whole second: neither a surface to slide on nor an undecided sign.
  Builder model("equal");
  const SX second = model.floor(model.time());
  static_cast<void>(model.state("x", {0}));
  static_cast<void>(model.state("y", {0}));
  model.dynamics("x", model.if_(model::greater_equal(second, 2), 1, 0));
  model.dynamics("y", model.if_(model::greater(second, 2), 1, 0));
  const auto result = run(model, {.until = 5.25});
  EXPECT_NEAR(result.final.x[0], 3.25, 1e-14);
  EXPECT_NEAR(result.final.x[1], 2.25, 1e-14);
  EXPECT_TRUE(result.events.empty());
}

TEST(CellRuns, SlidingOnATable) {
  Builder model("slide");
  const SX x = model.state("x", {-0.5}), z = model.state("z", {0.3});
  const auto road = model.table("road", {0, 1, 2, 3}, {0, 0.5, 0.2, 0});
  model.dynamics("x", 1);
  model.dynamics("z", -model.sign(z - road(x)));
  std::vector<double> times{0, 1, 1.5, 2, 2.5, 3, 3.5, 4};
  const auto result = run(model, {.until = 4, .times = times});
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
  EXPECT_NEAR(result.events[0].t, 0.3, 1e-14);
  // alpha follows the slope of the table: z' = 1 - 2 alpha = slope.
  const auto& rows = result.trajectory;
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const double slope = rows.t[i] > 0.5 && rows.t[i] < 1.5 ? 0.5 : -0.3;
    if (rows.t[i] != 1.0 && rows.t[i] != 2.0) continue;
    EXPECT_NEAR(rows.alpha[i][0], (1 - slope) / 2, 1e-12);
    EXPECT_NEAR(rows.x[i][1], rows.t[i] == 1.0 ? 0.25 : 0.35, 1e-14);
  }
  EXPECT_EQ(result.final.x[1], 0.0);
}

TEST(CellRuns, SlidingEndsAtAKinkThatIsTooSteep) {
  Builder model("steep");
  const SX x = model.state("x", {0}), z = model.state("z", {0});
  const auto wall = model.table("wall", {0, 1, 2}, {0, 0.5, 3.5});
  model.dynamics("x", 1);
  model.dynamics("z", -model.sign(z - wall(x)));
  const auto result = run(model, {.until = 1.5});
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
  EXPECT_NEAR(result.events[1].t, 1.0, 1e-14);
  EXPECT_NEAR(result.final.x[1], 1.0, 1e-13);  // left behind at speed 1
}

TEST(CellRuns, InputThatJumpsAwayEndsSliding) {
  Builder model("steps");
  const SX x = model.state("x", {1}), u = model.control("u", {0});
  model.dynamics("x", -model.sign(x - u));
  model.input("u", {0, 1.5, 2, 3}, {0, 0, 2, -1});
  const auto result = run(model, {.until = 4});
  ASSERT_EQ(result.events.size(), 3U);
  EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
  EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
  EXPECT_NEAR(result.events[1].t, 2.0, 1e-15);
  EXPECT_EQ(*result.events[1].mode_after, (result::Mode{-1}));
  EXPECT_NE(result.events[1].reason.find("jump of u"), std::string::npos) << result.events[1].reason;
  EXPECT_EQ(result.events[2].kind, EventKind::crossing);  // psi flips without passing 0
  EXPECT_NEAR(result.events[2].t, 3.0, 1e-15);
  EXPECT_NEAR(result.final.x[0], 0.0, 1e-14);
  // Rows before and behind an event have the input before and behind.
  const auto& rows = result.trajectory;
  for (std::size_t i = 0; i + 1 < rows.t.size(); ++i) {
    if (rows.t[i] != result.events[2].t || rows.t[i + 1] != rows.t[i]) continue;
    EXPECT_EQ(rows.u[i][0], 2.0);
    EXPECT_EQ(rows.u[i + 1][0], -1.0);
  }
}

TEST(CellRuns, SlidingGoesOnWhereOnlyTheFieldJumps) {
  Builder model("square wave");
  const SX t = model.time(), x = model.state("x", {0});
  const SX wave = 1 - 2 * model.mod(model.floor(t), 2);
  model.dynamics("x", wave - 2 * model.sign(x));
  const auto result = run(model, {.until = 5.5});
  ASSERT_EQ(result.events.size(), 1U);  // the start
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_NEAR(result.final.alpha[0], 0.25, 1e-14);
}

/// References from 0, or 0.2, to a value r that they jump to at t = 1.
struct SteppedReference {
  const char* what;
  double low;
  SX (*of)(Builder& model, const SX& t, const SX& x, const SX& u);
};

TEST(CellRuns, SurfacesWhoseInnerSignsJumpAreLeft) {
  // y slides on a stepped reference: at the step it stays where it is, and rises from there with rate 1.
  const SteppedReference references[] = {
      {"whole part", 0.0,
       [](Builder& model, const SX& t, const SX&, const SX&) {
         return model.if_(model::greater(model.floor(t), 0.5), 2, 0);
       }},
      {"equality", 0.0,
       [](Builder& model, const SX& t, const SX&, const SX&) {
         return model.if_(model::greater_equal(model.floor(t), 1), 2, 0);
       }},
      {"two levels", 0.0,
       [](Builder& model, const SX& t, const SX&, const SX&) {
         const SX inner = model.if_(model::greater(model.floor(t), 0.5), 1, -1);
         return model.if_(model::greater(inner, 0), 2, 0);
       }},
      {"state and whole part", 0.0,
       [](Builder& model, const SX& t, const SX& x, const SX&) {
         return model.if_(model::greater(x + model.floor(t), 1.5), 2, 0);
       }},
      {"sampled input", 0.0,
       [](Builder& model, const SX&, const SX&, const SX& u) {
         model.input("u", {0, 1}, {0, 1});
         return model.if_(model::greater(u, 0.5), 2, 0);
       }},
      {"kink of an input", 0.2,
       [](Builder& model, const SX&, const SX&, const SX& u) {
         model.input("u", {0, 1}, {0, 1});
         return model.max(u, 0.2);
       }},
  };
  for (const auto method : {ode::Method::dopri5, ode::Method::radau5, ode::Method::taylor}) {
    for (const auto& reference : references) {
      Builder model("stepped");
      const SX t = model.time(), x = model.state("x", {0}), y = model.state("y", {0.7}), u = model.control("u", {0});
      model.dynamics("x", 1);
      model.dynamics("y", model.sign(reference.of(model, t, x, u) - y));
      const auto result = run(model, {.until = 1.4, .method = method});
      EXPECT_NEAR(result.final.x[1], reference.low + 0.4, 1e-13) << reference.what;
      ASSERT_EQ(result.events.size(), 2U) << reference.what;
      EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding) << reference.what;
      EXPECT_NEAR(result.events[1].t, 1.0, 1e-15) << reference.what;
    }
  }
}

TEST(CellRuns, ABreakAtZeroIsPassedOnceFromBeforeIt) {
  // Guards rise where the sawtooth falls. Steps from t < 0 end at 0 to the rounding of their beginnings.
  for (const auto method : {ode::Method::radau5, ode::Method::radau9, ode::Method::radau13}) {
    for (const double period : {0.3, 1.078}) {
      Builder model("resets");
      const SX t = model.time(), x = model.state("x", {0.5}), y = model.state("y", {0});
      const SX n = model.discrete_state("n", 0);
      model.dynamics("x", 0.1 * cos(3 * t));
      model.dynamics("y", model.if_(model::less(model.mod(t, period), 0.5 * period), 1, -1));
      model.jump(x - model.mod(t, period) / period, model::Direction::up, {{"n", n + 1.0}});
      const auto result = run(model, {.from = -0.3, .until = 1.6, .method = method, .rtol = 1e-8});
      EXPECT_EQ(result.final.x[2], period < 1.0 ? 6.0 : 2.0) << period << " " << static_cast<int>(method);
    }
  }
}

TEST(CellRuns, ConditionsOfEventsTurnAtResets) {
  Builder model("edges");
  const SX t = model.time();
  static_cast<void>(model.state("x", {0}));
  model.dynamics("x", 1);
  model.event(model::greater(model.mod(t, 1), 0.25), {.name = "up", .direction = model::Direction::up});
  model.event(model::greater(model.mod(t, 1), 0.25), {.name = "down", .direction = model::Direction::down});
  const auto result = run(model, {.until = 10.1});
  int up = 0, down = 0;
  for (const auto& event : result.events) {
    const double phase = event.t - std::floor(event.t + 1e-9);
    EXPECT_NEAR(phase, *event.name == "up" ? 0.25 : 0.0, 1e-13) << event.t;
    ++(*event.name == "up" ? up : down);
  }
  EXPECT_EQ(up, 10);
  EXPECT_EQ(down, 10);
}

TEST(CellRuns, StartsAndTurnsAtBreaks) {
  // x moves down through the breaks from one at which it starts, turns, and comes up again.
  Builder model("down and up");
  const SX t = model.time(), x = model.state("x", {2});
  static_cast<void>(model.state("y", {0}));
  const auto hat = model.table("hat", {0, 1, 2}, {0, 1, 0});
  model.dynamics("x", -cos(t));
  model.dynamics("y", hat(x));
  const auto result = run(model, {.until = std::numbers::pi});
  // x = 2 - sin t; hat = sin t.
  EXPECT_NEAR(result.final.x[1], 2.0, 1e-12);
}

TEST(CellRuns, TablesOfBranchesThatAreNotTaken) {
  Builder model("guarded");
  const SX x = model.state("x", {-1});
  const auto road = model.table("road", {0, 0.5, 2}, {1, 2, 1});
  model.dynamics("x", model.if_(model::greater(x, 0), road(sqrt(x + 0.25)), 1));
  const auto result = run(model, {.until = 1.0 + 1e-3});
  // The root is defined from -0.25 on, the table is used from 0 on, where it is at its greatest value.
  EXPECT_NEAR(result.final.x[0], 2e-3, 1e-6);
}

/// Errors at fixed steps through the breaks of a table; the slope of log(error) over log(h).
double order_through(model::TableKind kind, ode::Method method, double h) {
  const auto end = [&](double step, ode::Method with, double rtol) {
    Builder model("order");
    const SX x = model.state("x", {0.1}), y = model.state("y", {1});
    const auto road = model.table("road", {0, 0.7, 1.5, 2.1, 3.3, 4}, {0.2, 0.9, 0.4, 1.3, 0.7, 1.1}, kind);
    model.dynamics("x", 1 + 0.5 * sin(3 * y));
    model.dynamics("y", -y * road(x) + cos(x));
    return run(model, {.until = 3.0, .method = with, .rtol = rtol, .max_step = step}).final.x[1];
  };
  const double exact = end(0.05, ode::Method::dop853, 1e-13);
  const double coarse = std::abs(end(h, method, 1e6) - exact), fine = std::abs(end(h / 8, method, 1e6) - exact);
  return std::log2(coarse / fine) / 3;
}

TEST(CellRuns, OrderThroughTables) {
  for (const auto kind : {model::TableKind::linear, model::TableKind::cubic}) {
    // A step across a break would leave order 2 (linear) or 4 (cubic).
    EXPECT_GT(order_through(kind, ode::Method::dopri5, 0.16), 4.5);
    EXPECT_GT(order_through(kind, ode::Method::radau5, 0.16), 4.5);
    EXPECT_GT(order_through(kind, ode::Method::dop853, 0.5), 6.5);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
