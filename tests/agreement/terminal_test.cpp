// Terminal sliding modes and time-optimal feedback: curves that are slid on, or along, into the origin, which is
// reached in finite time and held as long as the drive is weaker than the control. References are closed forms.
#include <algorithm>
#include <cmath>
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

/// Every method at 1e-8 and 1e-10.
std::vector<Accuracy> accuracies() {
  std::vector<Accuracy> all;
  for (const auto integrator : {pipeline::Integrator::dop853, pipeline::Integrator::dopri5,
                                pipeline::Integrator::radau5, pipeline::Integrator::taylor}) {
    for (const double rtol : {1e-8, 1e-10}) all.push_back({integrator, rtol, 1e-2 * rtol});
  }
  return all;
}

/// x' = v and v' as given.
std::string double_integrator(double x, double v, const std::string& force, double until) {
  return fmt::format(
      "[model]\nname = \"m\"\n[states]\nx = {:.17g}\nv = {:.17g}\n[dynamics]\nx = \"v\"\n"
      "v = \"{}\"\n[simulate]\nuntil = {}\n",
      x, v, force, until);
}

Result completed(const std::string& text, const Accuracy& accuracy) {
  const Result result = simulate_text(text, accuracy);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message << "\n" << text;
  return result;
}

/// At rest at the origin to the end, exactly; the last event is the arrival there.
void expect_rest(const Result& result, double arrival, double tolerance) {
  ASSERT_FALSE(result.events.empty());
  const Event& last = result.events.back();
  EXPECT_NEAR(last.t, arrival, tolerance);
  EXPECT_NE(last.reason.find("higher-order sliding"), std::string::npos) << last.reason;
  EXPECT_EQ(last.unique, true);
  EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_EQ(result.final.x[1], 0.0);
}

/// The only root of f between a and b, by bisection.
template <class Function>
double root(Function f, double a, double b) {
  const bool rises = f(b) > 0.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (a + b);
    ((f(middle) > 0.0) == rises ? b : a) = middle;
  }
  return 0.5 * (a + b);
}

double signed_power(double x, double q) { return std::copysign(std::pow(std::abs(x), q), x); }

// x' = -c |x|^q sign(x) on the curve: |x|^(1 - q) falls with the rate c (1 - q). Reached from v' = d - k sign(s).
TEST(TerminalSliding, ReachesTheOriginAndStays) {
  struct Case {
    double k, c, q, x, v, d;
  };
  for (const Case& m : {Case{2, 1, 0.5, 1, 0, 0}, Case{2, 1, 0.6, 1, 0, 0}, Case{2, 1, 0.5, -1, 0.3, 0.4},
                        Case{3, 1.5, 2.0 / 3.0, 0.3, -2, 0.2}, Case{1.7, 0.9, 0.75, -0.83, -0.37, 0.1}}) {
    const auto s = [&](double t, double side) {
      const double rate = m.d - side * m.k;
      return m.v + rate * t + m.c * signed_power(m.x + m.v * t + 0.5 * rate * t * t, m.q);
    };
    const double side = s(0.0, 0.0) > 0.0 ? 1.0 : -1.0;
    const double met = root([&](double t) { return s(t, side); }, 0.0, 2.0);
    const double x = m.x + m.v * met + 0.5 * (m.d - side * m.k) * met * met;
    const double arrival = met + std::pow(std::abs(x), 1.0 - m.q) / (m.c * (1.0 - m.q));
    const std::string force = fmt::format("{}-{}*sign(v+{}*abs(x)^{:.17g}*sign(x))", m.d, m.k, m.c, m.q);
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(double_integrator(m.x, m.v, force, arrival + 1.0), accuracy);
      ASSERT_EQ(result.events.size(), 2U);
      EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
      EXPECT_NEAR(result.events[0].t, met, 10.0 * accuracy.rtol);
      EXPECT_EQ(result.events[1].kind, EventKind::change_sliding);
      // An error e of x made at x moves the arrival by e / |x'|: of rtol x, by rtol times what is left until then.
      expect_rest(result, arrival, 10.0 * accuracy.rtol * arrival);
      // v' = 0: alpha = 1/2 + d/(2 k).
      EXPECT_NEAR(result.final.alpha[0], 0.5 + 0.5 * m.d / m.k, 1e-12);
    }
  }
}

// A disturbance moves the selection, and not the motion on the curve.
TEST(TerminalSliding, ADisturbanceDoesNotMoveTheArrival) {
  const auto x = [](double t) { return 1.0 - t * t + 0.1 * t - 0.1 / 3.0 * std::sin(3.0 * t); };
  const auto v = [](double t) { return -2.0 * t + 0.1 - 0.1 * std::cos(3.0 * t); };
  const double met = root([&](double t) { return v(t) + std::sqrt(x(t)); }, 0.0, 0.7);
  const double arrival = met + 2.0 * std::sqrt(x(met));
  for (const auto& accuracy : accuracies()) {
    const Result result =
        completed(double_integrator(1, 0, "0.3*sin(3*t)-2*sign(v+sqrt(abs(x))*sign(x))", 6.0), accuracy);
    expect_rest(result, arrival, 10.0 * accuracy.rtol * arrival);
    EXPECT_NEAR(result.final.alpha[0], 0.5 + 0.3 * std::sin(18.0) / 4.0, 1e-12);
    // v' = 1/2 on the curve up to the origin; the last step lies up to 1.5e-3 before it, and 0.9/4 is the rate.
    EXPECT_NEAR(result.events.back().alpha_before.value().at(0), 0.5 + (0.3 * std::sin(3.0 * arrival) - 0.5) / 4.0,
                5e-4);
  }
}

// s = x + b |v|^p sign(v): v = -(x/b)^(1/p) on the curve.
TEST(TerminalSliding, NonsingularSurfaces) {
  for (const double p : {1.5, 5.0 / 3.0, 9.0 / 7.0}) {
    const double b = 0.7;
    const auto x = [](double t) { return 0.5 + t - t * t; };
    const auto s = [&](double t) { return x(t) + b * signed_power(1.0 - 2.0 * t, p); };
    const double met = root(s, 0.5, 2.0);
    const double arrival = met + std::pow(b, 1.0 / p) * std::pow(x(met), 1.0 - 1.0 / p) / (1.0 - 1.0 / p);
    const std::string force = fmt::format("-2*sign(x+{}*abs(v)^{:.17g}*sign(v))", b, p);
    for (const auto& accuracy : accuracies()) {
      expect_rest(completed(double_integrator(0.5, 1, force, arrival + 1.0), accuracy), arrival,
                  10.0 * accuracy.rtol * arrival);
    }
  }
}

// s = v + a x + b sqrt(|x|) sign(x): y = sqrt(x) has y' = -(a y + b)/2.
TEST(TerminalSliding, FastTerminalSurfaces) {
  const auto x = [](double t) { return 1.0 - 1.5 * t * t; };
  const double met = root([&](double t) { return -3.0 * t + x(t) + std::sqrt(x(t)); }, 0.1, 0.8);
  const double arrival = met + 2.0 * std::log(1.0 + std::sqrt(x(met)));
  for (const auto& accuracy : accuracies()) {
    expect_rest(completed(double_integrator(1, 0, "-3*sign(v+x+sqrt(abs(x))*sign(x))", 4.0), accuracy), arrival,
                10.0 * accuracy.rtol * arrival);
  }
}

// One switch at x = -v |v|/2, along which the field of one side goes itself: T = v + 2 sqrt(v^2/2 + x) above it.
TEST(TimeOptimal, FeedbackArrivesAfterOneSwitch) {
  for (const auto& [x, v] :
       {std::pair{1.0, 0.0}, {2.0, 1.0}, {1.0, -1.0}, {0.3, -2.7}, {0.503, -1.738}, {0.125, -0.5}}) {
    for (const double side : {1.0, -1.0}) {
      const bool above = x + 0.5 * v * std::abs(v) >= 0.0;
      const double peak = std::sqrt(0.5 * v * v + (above ? x : -x));
      const double arrival = (above ? v : -v) + 2.0 * peak;
      for (const std::string force :
           {"-sign(x + v*abs(v)/2)", "if(x + v*abs(v)/2 > 0, -1, if(x + v*abs(v)/2 < 0, 1, -sign(v)))"}) {
        const bool nested = force.front() == 'i';
        for (const auto& accuracy : accuracies()) {
          const Result result = completed(double_integrator(side * x, side * v, force, arrival + 1.0), accuracy);
          ASSERT_FALSE(result.events.empty());
          // Parabolas are exact: what is left is rounding.
          EXPECT_NEAR(result.events.back().t, arrival, 1e-12);
          EXPECT_EQ(result.final.x[0], 0.0);
          EXPECT_EQ(result.final.x[1], 0.0);
          if (!nested) expect_rest(result, arrival, 1e-12);
        }
      }
    }
  }
}

// The same feedback with a root, of any authority k: the field of one side is tangent to the curve to rounding only.
TEST(TimeOptimal, FeedbackWithARootGoesAlongItsCurve) {
  for (const double k : {1.0, 1.3, 0.1}) {
    for (const auto& [x, v] : {std::pair{1.0, 0.0}, {0.83, -0.4}, {0.3, 0.9}}) {
      const double peak = std::sqrt(0.5 * v * v + k * x);
      const double arrival = (v + 2.0 * peak) / k;
      for (const double side : {1.0, -1.0}) {
        const std::string force = fmt::format("-{0}*sign(v + sqrt(2*{0}*abs(x))*sign(x))", k);
        for (const auto& accuracy : accuracies()) {
          const Result result = completed(double_integrator(side * x, side * v, force, arrival + 1.0), accuracy);
          ASSERT_EQ(result.events.size(), 2U);
          EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
          EXPECT_NEAR(result.events[0].t, (v + peak) / k, 1e-12 / k);
          expect_rest(result, arrival, accuracy.rtol * arrival);
        }
      }
    }
  }
}

// A curve that is too steep, x = v^2/4, is crossed: from v = 0 at x to v = 0 at -x/3 in 4 sqrt(x/3). 4/(sqrt(3) - 1) in
// all; cycles are extrapolated.
TEST(TimeOptimal, CurvesThatAreCrossedSpiralIntoTheOrigin) {
  for (const std::string force : {"-sign(x+v*abs(v)/4)", "-sign(v+2*sqrt(abs(x))*sign(x))"}) {
    for (const double x : {1.0, -1.0}) {
      for (const auto& accuracy : accuracies()) {
        const Result result = completed(double_integrator(x, 0, force, 8.0), accuracy);
        EXPECT_EQ(result.events.back().kind, EventKind::accumulation);
        expect_rest(result, 4.0 / (std::sqrt(3.0) - 1.0), accuracy.rtol);
      }
    }
  }
}

// With a margin the curve is slid on: v' = b there.
TEST(TimeOptimal, ACurveWithAMarginIsSlidOn) {
  const double b = 0.6;
  for (const double d : {0.2, -0.3}) {
    const double rate = d - 1.0;
    const double met = 1.0 / std::sqrt(0.5 * rate * rate / b - 0.5 * rate);
    const double arrival = met - rate * met / b;
    const std::string force = fmt::format("{}-sign(x+v*abs(v)/{})", d, 2.0 * b);
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(double_integrator(1, 0, force, arrival + 1.0), accuracy);
      ASSERT_EQ(result.events.size(), 2U);
      EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
      EXPECT_NEAR(result.events[0].t, met, 1e-12);
      expect_rest(result, arrival, 10.0 * accuracy.rtol * arrival);
    }
  }
}

TEST(TerminalSliding, AStartAtTheOriginStays) {
  for (const std::string force : {"0.3*sin(3*t)-2*sign(v+sqrt(abs(x))*sign(x))", "0.3*sin(3*t)-sign(x+v*abs(v)/1.2)",
                                  "0.3*sin(3*t)-1.5*sign(x+abs(v)^1.5*sign(v))"}) {
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(double_integrator(0, 0, force, 4.0), accuracy);
      ASSERT_EQ(result.events.size(), 1U);
      EXPECT_EQ(result.events[0].kind, EventKind::start);
      EXPECT_EQ(result.events[0].unique, true);
      EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
      EXPECT_EQ(result.final.x[0], 0.0);
      EXPECT_EQ(result.final.x[1], 0.0);
    }
  }
}

// v' = +-2 from the beginning.
TEST(TerminalSliding, AStartAtTheOriginThatNothingHoldsLeaves) {
  for (const std::string control :
       {"sign(v+sqrt(abs(x))*sign(x))", "sign(x+v*abs(v)/2)", "sign(x+abs(v)^1.5*sign(v))"}) {
    for (const double side : {1.0, -1.0}) {
      for (const auto& accuracy : accuracies()) {
        const Result result =
            completed(double_integrator(0, 0, fmt::format("{}-{}", 3.0 * side, control), 0.5), accuracy);
        ASSERT_EQ(result.events.size(), 1U);
        EXPECT_EQ(result.events[0].unique, true);
        EXPECT_NEAR(result.final.x[0], side * 0.25, 1e-12);
        EXPECT_NEAR(result.final.x[1], side, 1e-12);
      }
    }
  }
}

// v' = -0.3 sign(v) - sign(s): friction gives the curve a margin, and both signs hold the origin together.
TEST(TimeOptimal, FrictionAndFeedbackHoldTheOriginTogether) {
  const double met = 1.0 / std::sqrt(0.35 + 0.5 * 0.49);
  for (const auto& accuracy : accuracies()) {
    const Result result = completed(double_integrator(1, 0, "-0.3*sign(v)-sign(x+v*abs(v)/2)", 5.0), accuracy);
    EXPECT_NEAR(result.events.back().t, 1.7 * met, 10.0 * accuracy.rtol);
    EXPECT_EQ(result.final.mode, (std::vector<int>{0, 0}));
    // One condition for two selections.
    EXPECT_TRUE(std::isnan(result.final.alpha[0]) && std::isnan(result.final.alpha[1]));
    EXPECT_EQ(result.final.x[0], 0.0);
    EXPECT_EQ(result.final.x[1], 0.0);
  }
}

// 1.1 sin(t) is stronger than the control from asin(1/1.1) on; the way back meets the curve, and then the origin.
TEST(TerminalSliding, ADriveThatIsTooStrongTakesTheStateAwayAndItComesBack) {
  const double begin = std::asin(1.0 / 1.1), c = 0.7;
  const auto v = [&](double t) { return -1.1 * (std::cos(t) - std::cos(begin)) - (t - begin); };
  const auto x = [&](double t) {
    return -1.1 * (std::sin(t) - std::sin(begin) - std::cos(begin) * (t - begin)) - 0.5 * (t - begin) * (t - begin);
  };
  const double met = root([&](double t) { return v(t) + c * std::sqrt(std::max(x(t), 0.0)); }, 2.0, 3.0);
  const double arrival = met + 2.0 * std::sqrt(x(met)) / c;
  for (const int side : {1, -1}) {
    const std::string force = fmt::format("{}*1.1*sin(t)-sign(v+0.7*sqrt(abs(x))*sign(x))", side);
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(double_integrator(0, 0, force, 3.5), accuracy);
      const auto events = switches_of(result);
      ASSERT_EQ(events.size(), 3U);
      EXPECT_EQ(events[0].kind, EventKind::leave_sliding);
      EXPECT_EQ(*events[0].mode_after, (std::vector<int>{side}));
      EXPECT_NEAR(events[0].t, begin, 1e-12);
      EXPECT_EQ(events[1].kind, EventKind::enter_sliding);
      // The curve is met with the speed ds/dt = 0.8: errors of the state move that time by about themselves.
      EXPECT_NEAR(events[1].t, met, 30.0 * accuracy.rtol);
      expect_rest(result, arrival, 100.0 * accuracy.rtol);
    }
  }
}

// From t = 1 on three times the authority, until 1.5: then x = 1/4, v = 1.
TEST(TimeOptimal, ADriveThatJumpsTakesTheStateAway) {
  const double arrival = 1.5 + 1.0 + 2.0 * std::sqrt(0.5 + 0.25);
  for (const std::string sign : {"", "-"}) {
    const std::string force = sign + "3*(step(t-1)-step(t-1.5))-sign(x+v*abs(v)/2)";
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(double_integrator(0, 0, force, 6.0), accuracy);
      const auto events = switches_of(result);
      ASSERT_EQ(events.size(), 3U);
      EXPECT_EQ(events[0].kind, EventKind::leave_sliding);
      EXPECT_EQ(events[0].t, 1.0);
      expect_rest(result, arrival, 1e-12);
    }
  }
}

// Units of length and time.
TEST(TerminalSliding, ScalesChangeNothing) {
  const double met = 1.0 / std::sqrt(5.0);
  const double arrival = met + 2.0 * std::sqrt(0.8);
  for (const double length : {1e-6, 1.0, 1e6}) {
    for (const double time : {1e-6, 1.0, 1e6}) {
      const double speed = length / time;
      const std::string force =
          fmt::format("-{:.17g}*sign(v+{:.17g}*sqrt(abs(x))*sign(x))", 2.0 * speed / time, std::sqrt(length) / time);
      for (auto accuracy : accuracies()) {
        accuracy.atol *= std::min(length, speed);
        const Result result = completed(double_integrator(length, 0, force, 4.0 * time), accuracy);
        expect_rest(result, arrival * time, 10.0 * accuracy.rtol * arrival * time);
      }
    }
  }
}

// Two of them in one model: one rests, the other one slides, or both arrive together.
TEST(TerminalSliding, CopiesDoNotMindEachOther) {
  const auto text = [](double y) {
    return fmt::format(
        "[model]\nname = \"m\"\n[states]\nx = 1\nv = 0\ny = {}\nw = 0\n[dynamics]\nx = \"v\"\n"
        "v = \"-2*sign(v+sqrt(abs(x))*sign(x))\"\ny = \"w\"\nw = \"-2*sign(w+sqrt(abs(y))*sign(y))\"\n"
        "[simulate]\nuntil = 6\n",
        y);
  };
  // Lengths that are four times as long take twice the time.
  const double arrival = 1.0 / std::sqrt(5.0) + 2.0 * std::sqrt(0.8);
  for (const double y : {1.0, -1.0, 4.0, -4.0}) {
    const double other = arrival * std::sqrt(std::abs(y));
    for (const auto& accuracy : accuracies()) {
      const Result result = completed(text(y), accuracy);
      ASSERT_EQ(result.events.size(), other > arrival ? 4U : 2U);
      EXPECT_NEAR(result.events.back().t, other, 10.0 * accuracy.rtol * other);
      EXPECT_NEAR(result.events[result.events.size() / 2].t, std::abs(y) > 1.0 ? arrival : other,
                  10.0 * accuracy.rtol * other);
      EXPECT_EQ(result.final.mode, (std::vector<int>{0, 0}));
      EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0, 0.0, 0.0}));
    }
  }
}

// With a largest speed: x' = -1 until c |x|^q = 1, from there the curve. The bound is nested around x, too, and has one
// sign where x is held.
TEST(TerminalSliding, SpeedsThatAreBounded) {
  struct Case {
    const char* speed;
    double c, q;
  };
  for (const Case& m :
       {Case{"min(1.2*abs(x)^0.5,1)*sign(x)", 1.2, 0.5}, Case{"max(-1,min(1,1.2*sqrt(abs(x))*sign(x)))", 1.2, 0.5},
        Case{"min(0.9*abs(x)^0.75,1)*sign(x)", 0.9, 0.75}}) {
    for (const double side : {1.0, -1.0}) {
      // v' = -2 side until v = -side.
      const double met = 0.5;
      const double bound = std::pow(m.c, -1.0 / m.q);
      const double arrival = met + (2.75 - bound) + std::pow(bound, 1.0 - m.q) / (m.c * (1.0 - m.q));
      const std::string force = fmt::format("-2*sign(v+{})", m.speed);
      for (const auto& accuracy : accuracies()) {
        const Result result = completed(double_integrator(3.0 * side, 0, force, arrival + 1.0), accuracy);
        ASSERT_EQ(result.events.size(), 2U);
        EXPECT_NEAR(result.events[0].t, met, 10.0 * accuracy.rtol);
        expect_rest(result, arrival, 10.0 * accuracy.rtol * arrival);
      }
    }
  }
}

// Roots flatter at the origin than a square root need motions there far below the rounding of the fields: those of each
// copy, while the others slide or rest.
TEST(TerminalSliding, CopiesOfFlatRootsAreAsExact) {
  const std::string text = R"toml(
[model]
name = "m"
[states]
x = 1
v = 0
y = -0.7
w = 0.2
[dynamics]
x = "v"
v = "-2*sign(v+abs(x)^0.75*sign(x))"
y = "w"
w = "0.1-2*sign(w+0.9*abs(y)^0.75*sign(y))"
[simulate]
until = 5
)toml";
  const double met = root([](double t) { return -2.0 * t + signed_power(1.0 - t * t, 0.75); }, 0.0, 0.7);
  const double arrival = met + 4.0 * std::pow(1.0 - met * met, 0.25);
  const auto y = [](double t) { return -0.7 + 0.2 * t + 1.05 * t * t; };
  const double other_met = root([&](double t) { return 0.2 + 2.1 * t + 0.9 * signed_power(y(t), 0.75); }, 0.0, 0.4);
  const double other = other_met + 4.0 / 0.9 * std::pow(-y(other_met), 0.25);
  for (const auto& accuracy : accuracies()) {
    const Result result = completed(text, accuracy);
    ASSERT_EQ(result.events.size(), 4U);
    EXPECT_NEAR(result.events[2].t, other, 10.0 * accuracy.rtol * other);
    // Where the first one arrives the second one is (arrival - other)^4/256 away, moves by the cube of that over 64,
    // and is known to the tolerance of the run.
    const double speed = std::pow(arrival - other, 3.0) / 64.0;
    EXPECT_NEAR(result.events[3].t, arrival, 10.0 * accuracy.rtol * arrival + accuracy.atol / speed);
    EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0, 0.0, 0.0}));
  }
}

// The origin moves: x - sin(t) and v - cos(t) are held, and another state goes on.
TEST(TerminalSliding, ReferencesThatMoveAreHeld) {
  const std::string text = R"toml(
[model]
name = "m"
[states]
x = 1
v = 1
z = 0
[dynamics]
x = "v"
v = "-sin(t)-2*sign(v-cos(t)+sqrt(abs(x-sin(t)))*sign(x-sin(t)))"
z = "v"
[simulate]
until = 4
)toml";
  const double arrival = 1.0 / std::sqrt(5.0) + 2.0 * std::sqrt(0.8);
  for (const auto& accuracy : accuracies()) {
    const Result result = completed(text, accuracy);
    ASSERT_EQ(result.events.size(), 2U);
    // x - sin(t) is followed to 1e-10, of which errors are some 1e-4; its root, 1e-5, is the time that is left.
    EXPECT_NEAR(result.events.back().t, arrival, std::max(10.0 * accuracy.rtol, 1e-8));
    EXPECT_NEAR(result.final.x[0], std::sin(4.0), 1e-14);
    EXPECT_NEAR(result.final.x[1], std::cos(4.0), 1e-14);
    EXPECT_NEAR(result.final.x[2], std::sin(4.0) - 1.0, 100.0 * accuracy.rtol);
  }
}

}  // namespace
}  // namespace saltus::problems
