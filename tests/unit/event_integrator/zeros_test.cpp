// Zeros that are none, of surfaces and guards: what a jump leaves at zero, what slides there, what decays to it.
#include <cmath>
#include <string>
#include <vector>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using model::Direction;
using result::Termination;

constexpr ode::Method methods_at_zero[] = {ode::Method::dopri5, ode::Method::dop853,  ode::Method::radau5,
                                           ode::Method::radau9, ode::Method::radau13, ode::Method::taylor};

Integration run_with(Builder& builder, double until, ode::Method method) {
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-8, 1e-10};
  options.until = until;
  return testing::run_model(builder, options);
}

/// Columns of the state that counts.
double counted(const Integration& run) {
  EXPECT_EQ(run.status.termination, Termination::completed) << run.status.message;
  return run.final.x.back();
}

TEST(JumpsAtZero, AGuardThatIsSetToZeroIsPassedOnce) {
  for (const auto method : methods_at_zero) {
    Builder b("counter");
    const SX x = b.state("x", {1.0});
    const SX n = b.state("n", {0.0});
    b.dynamics("x", -sin(b.time()));
    b.dynamics("n", 0.0);
    b.jump(x, Direction::both, {{"x", 0.0}, {"n", n + 1.0}});
    EXPECT_EQ(counted(run_with(b, 10.0, method)), 3.0) << static_cast<int>(method);
  }
}

/// A ring is entered and left within one step: both are counted, by a guard and by a surface.
TEST(Zeros, AShortDipHasTwo) {
  for (const auto method : methods_at_zero) {
    for (const double start : {-1.06, -1.1, -1.274, -1.3, -1.424, -1.648, -1.787, -1.911}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " from " << start);
      Builder b("ring");
      const SX x = b.state("x", {start});
      const SX inside = b.state("inside", {0.0});
      const SX n = b.state("n", {0.0});
      const SX distance = sqrt(x * x + 0.004356) - 0.2;
      b.dynamics("x", 4.945);
      b.dynamics("inside", b.step(-distance));
      b.dynamics("n", 0.0);
      b.jump(distance, Direction::both, {{"n", n + 1.0}});
      const auto run = run_with(b, 1.9735085945399393, method);
      EXPECT_EQ(counted(run), 2.0);
      EXPECT_NEAR(run.final.x[1], 2.0 * std::sqrt(0.04 - 0.004356) / 4.945, 1e-12);
    }
  }
}

/// x = cos(t) 0.9^n.
TEST(JumpsAtZero, AGuardThatIsScaledAtZeroIsPassedOnce) {
  for (const auto method : methods_at_zero) {
    Builder b("scaled");
    const SX x = b.state("x", {1.0});
    const SX v = b.state("v", {0.0});
    const SX n = b.state("n", {0.0});
    b.dynamics("x", v);
    b.dynamics("v", -x);
    b.dynamics("n", 0.0);
    b.jump(x, Direction::both, {{"x", 0.9 * x}, {"v", 0.9 * v}, {"n", n + 1.0}});
    const auto run = run_with(b, 10.0, method);
    EXPECT_EQ(counted(run), 3.0) << static_cast<int>(method);
    EXPECT_NEAR(run.final.x[0], std::pow(0.9, 3) * std::cos(10.0), 1e-7) << static_cast<int>(method);
  }
}

TEST(JumpsAtZero, AGuardThatIsASwitchingFunctionGoesWhereItGoes) {
  for (const auto method : methods_at_zero) {
    for (int k = 0; k < 20; ++k) {
      Builder b("down");
      const SX x = b.state("x", {0.3 + 0.1 * k});
      const SX n = b.state("n", {0.0});
      b.dynamics("x", -1.0 - 0.5 * b.sign(x) - 0.3 * x);
      b.dynamics("n", 0.0);
      b.jump(x, Direction::up, {{"n", n + 1.0}});
      EXPECT_EQ(counted(run_with(b, 4.0, method)), 0.0) << static_cast<int>(method) << " " << k;
    }
  }
}

/// A block that sticks counts where it begins to move.
TEST(JumpsAtZero, AGuardThatIsSlidOnPassesWhereSlidingEnds) {
  for (const auto method : methods_at_zero) {
    for (const auto& [force, motions] : {std::pair{2.23, 3.0}, std::pair{0.5, 0.0}}) {
      Builder b("stick and slip");
      const SX q = b.state("q", {0.0});
      const SX v = b.state("v", {0.0});
      const SX n = b.state("n", {0.0});
      b.dynamics("q", v);
      b.dynamics("v", force * sin(b.time()) - b.sign(v) - 0.2 * q);
      b.dynamics("n", 0.0);
      b.jump(v, Direction::up, {{"n", n + 1.0}});
      EXPECT_EQ(counted(run_with(b, 15.0, method)), motions) << static_cast<int>(method);
    }
  }
}

/// What a second jump of the same time triggers does not look at the rounding of the first one's guard again.
TEST(JumpsAtZero, ABounceIsOneWhateverElseHappensThere) {
  for (const auto method : methods_at_zero) {
    for (int k = 0; k < 10; ++k) {
      const double height = 0.6 + 0.0813 * k;
      Builder b("ball");
      const SX y = b.state("y", {height});
      const SX v = b.state("v", {0.0});
      const SX w = b.state("w", {0.0});
      const SX n = b.state("n", {0.0});
      b.dynamics("y", v);
      b.dynamics("v", -9.81);
      b.dynamics("w", 1.0);
      b.dynamics("n", 0.0);
      b.jump(model::less(y, 0.0), {{"v", -0.8 * v}, {"w", 0.0}});
      b.jump(model::greater(y + w, 0.0), {{"n", n + 1.0}});
      const auto run = run_with(b, 2.0, method);
      ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
      const double fall = std::sqrt(2.0 * height / 9.81);
      double speed = 9.81 * fall, t = fall;
      double bounces = 0.0;
      for (double length = 0.0; t < 2.0; t += length, ++bounces) {
        speed *= 0.8;
        length = 2.0 * speed / 9.81;
      }
      const double left = t - 2.0;  // before the next bounce
      EXPECT_NEAR(run.final.x[0], (speed - 0.5 * 9.81 * left) * left, 1e-7)
          << static_cast<int>(method) << " " << height;
    }
  }
}

/// It arrives from below and stays: it is not above, and equality is true from there on.
TEST(JumpsAtZero, ConditionsOfWhatIsSlidOnAreAtEquality) {
  for (const auto method : methods_at_zero) {
    Builder b("arrival");
    const SX x = b.state("x", {-1.0});
    std::vector<SX> n;
    for (const char* name : {"above", "not_below", "below", "not_above"}) n.push_back(b.state(name, {0.0}));
    b.dynamics("x", -b.sign(x));
    for (const char* name : {"above", "not_below", "below", "not_above"}) b.dynamics(name, 0.0);
    b.jump(model::less(0.0, x), {{"above", n[0] + 1.0}});
    b.jump(model::less_equal(0.0, x), {{"not_below", n[1] + 1.0}});
    b.jump(model::less(x, 0.0), {{"below", n[2] + 1.0}});
    b.jump(model::less_equal(x, 0.0), {{"not_above", n[3] + 1.0}});
    const auto run = run_with(b, 3.0, method);
    EXPECT_EQ(run.status.termination, Termination::completed) << run.status.message;
    EXPECT_EQ(run.final.x, (std::vector<double>{0.0, 0.0, 1.0, 0.0, 0.0})) << static_cast<int>(method);
  }
}

TEST(JumpsAtZero, AGuardThatTwoSurfacesKeepIsNotCounted) {
  for (const auto method : methods_at_zero) {
    Builder b("corner");
    const SX x = b.state("x", {1.0});
    const SX y = b.state("y", {0.7});
    const SX n = b.state("n", {0.0});
    b.dynamics("x", -b.sign(x + y) - 0.3 * b.sign(x - 0.5 * y) + 0.2 * sin(3.0 * b.time()));
    b.dynamics("y", -b.sign(x + y) + 0.9 * b.sign(x - 0.5 * y) + 0.2 * cos(2.0 * b.time()));
    b.dynamics("n", 0.0);
    b.jump(x, Direction::up, {{"n", n + 1.0}});
    EXPECT_EQ(counted(run_with(b, 8.0, method)), 0.0) << static_cast<int>(method);
  }
}

/// The level of a tank that is put back to the rim, where the inflow goes on.
TEST(JumpsAtZero, AJumpThatIsTakenBackAtOnceEndsTheRun) {
  for (const auto method : methods_at_zero) {
    Builder b("tank");
    const SX h = b.state("h", {0.0});
    b.dynamics("h", 1.0);
    b.jump(model::less(1.0, h), {{"h", 1.0}});
    const auto run = run_with(b, 5.0, method);
    EXPECT_EQ(run.status.termination, Termination::outside_class) << static_cast<int>(method);
    EXPECT_NEAR(run.final.x[0], 1.0, 1e-12);
    EXPECT_NE(run.status.message.find("state the limit in [dynamics]"), std::string::npos);
  }
}

/// An alarm that raises its threshold the first time only: later executions set what does not move to what it is.
TEST(JumpsAtZero, AThresholdThatIsSetAgainToWhatItIsIsPassed) {
  for (const auto method : methods_at_zero) {
    Builder b("alarm");
    const SX x = b.state("x", {0.0});
    const SX phase = b.state("phase", {0.0});
    const SX n = b.state("n", {0.0});
    b.dynamics("x", cos(b.time()));
    b.dynamics("phase", 0.0);
    b.dynamics("n", 0.0);
    b.jump(model::less(0.5 + 0.1 * phase, x), {{"phase", 1.0}, {"n", n + 1.0}});
    EXPECT_EQ(counted(run_with(b, 20.0, method)), 5.0) << static_cast<int>(method);
  }
}

/// A ball at rest on a table, behind bounces that have accumulated, falls freely from where the table drops.
TEST(JumpsAtZero, ATableThatDropsLeavesTheBallInTheAir) {
  for (const auto method : methods_at_zero) {
    Builder b("table");
    const SX h = b.state("h", {1.0});
    const SX v = b.state("v", {0.0});
    b.dynamics("h", v);
    b.dynamics("v", -9.81);
    b.jump(h + b.floor(0.5 * b.time()), Direction::down, {{"v", -0.3 * v}});
    const auto run = run_with(b, 2.2, method);
    ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
    EXPECT_NEAR(run.final.x[0], -0.1962, 1e-9) << static_cast<int>(method);
    EXPECT_NEAR(run.final.x[1], -1.962, 1e-9) << static_cast<int>(method);
  }
}

/// Behind the jump the other argument is the larger one, and the condition stays true where they meet again.
TEST(GuardsWithKinks, AConditionThatStaysTrueBehindItsJumpFiresOnce) {
  for (const auto method : methods_at_zero) {
    Builder builder("alarm");
    const SX a = builder.state("a", {0.0});
    const SX b = builder.state("b", {-5.0});
    const SX n = builder.state("n", {0.0});
    builder.dynamics("a", 1.0);
    builder.dynamics("b", -1.0);
    builder.dynamics("n", 0.0);
    const auto hot = model::less(0.5, builder.max(a, b));
    builder.event(hot);
    builder.jump(hot, {{"b", 3.0}, {"n", n + 1.0}});
    const auto run = run_with(builder, 7.0, method);
    EXPECT_EQ(counted(run), 1.0) << static_cast<int>(method);
    EXPECT_NEAR(run.final.x[1], -3.5, 1e-12);
    EXPECT_EQ(run.events.size(), 2U) << static_cast<int>(method);
  }
}

TEST(GuardsWithKinks, AZeroThatIsTouchedAtAKinkIsNotPassed) {
  for (const auto method : methods_at_zero) {
    Builder b("touch");
    const SX x = b.state("x", {-1.0});
    const SX n = b.state("n", {0.0});
    b.dynamics("x", 1.0);
    b.dynamics("n", 0.0);
    b.jump(model::less(b.abs(x), 0.0), {{"n", n + 1.0}});
    b.jump(b.abs(x), Direction::down, {{"n", n + 1.0}});
    b.jump(b.max(x, 0.0), Direction::down, {{"n", n + 1.0}});
    b.jump(b.max(x, 0.0), Direction::up, {{"n", n + 8.0}});
    EXPECT_EQ(counted(run_with(b, 3.0, method)), 8.0) << static_cast<int>(method);
  }
}

/// What is compared is slid on from the event: the condition `x > 0` does not become true.
TEST(GuardsWithKinks, AnEventsConditionIsAtEqualityWhereItIsSlidOn) {
  for (const auto method : methods_at_zero) {
    Builder b("slide");
    const SX x = b.state("x", {-1.0});
    b.dynamics("x", -b.sign(x));
    b.event(model::less(0.0, x));
    const auto run = run_with(b, 3.0, method);
    ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
    EXPECT_EQ(run.events.size(), 1U) << static_cast<int>(method);
  }
}

/// A rate limiter at rest on a set point that depends on a phase: the jump of the phase moves the set point, not the
/// state.
TEST(JumpsAtZero, AJumpInsideOfWhatIsSlidOnDoesNotMoveTheState) {
  for (const auto method : methods_at_zero) {
    Builder b("limiter");
    const SX d = b.state("d", {0.0});
    const SX y = b.state("y", {0.7});
    b.dynamics("d", 0.0);
    b.dynamics("y", b.sign(b.if_(model::less(0.5, d), 2.0, 0.0) - y));
    b.jump(b.time() - 1.0, Direction::up, {{"d", 1.0}});
    EXPECT_NEAR(counted(run_with(b, 1.4, method)), 0.4, 1e-9) << static_cast<int>(method);
  }
}

constexpr double decay_rates[] = {1.0, 5.0, 40.0};

/// Until exp(-600): doubles end at exp(-745).
void expect_no_event(Builder& builder, ode::Method method, double rate, double tolerance) {
  const auto what =
      std::to_string(static_cast<int>(method)) + " " + std::to_string(rate) + " " + std::to_string(tolerance);
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {tolerance, 0.01 * tolerance};
  options.until = 600.0 / rate;
  const auto run = testing::run_model(builder, options);
  EXPECT_EQ(run.status.termination, Termination::completed) << what << ": " << run.status.message;
  EXPECT_EQ(run.events.size(), 0U) << what;
}

/// A step that is too long for what decays ends beyond zero, where the field would not have gone.
TEST(Decay, ASurfaceIsNotReached) {
  for (const auto method : testing::every_method) {
    for (const double rate : decay_rates) {
      for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
        Builder b("decay");
        const SX v = b.state("v", {1.0});
        b.state("q", {0.0});
        b.dynamics("v", -rate * v);
        b.dynamics("q", b.sign(v));
        expect_no_event(b, method, rate, tolerance);
      }
    }
  }
}

TEST(Decay, AConditionOfAJumpDoesNotBecomeTrue) {
  for (const auto method : testing::every_method) {
    for (const double rate : decay_rates) {
      for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
        Builder b("decay");
        const SX v = b.state("v", {1.0});
        const SX n = b.state("n", {0.0});
        b.dynamics("v", -rate * v);
        b.dynamics("n", 0.0);
        b.jump(model::less(v, 0.0), {{"n", n + 1.0}});
        expect_no_event(b, method, rate, tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::event_integrator
