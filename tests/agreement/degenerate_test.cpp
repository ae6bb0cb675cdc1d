// Degenerate situations, each for switching functions scaled by 1e8 and 1e-8: grazing, coincident and nearly coincident
// arrivals, exits whose selection is flat at its bound, time reversed. References are closed forms.
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

struct ScaledModel {
  std::string states, psi, dynamics, simulate;
};

/// Every switching function s1, s2, ... as `scale` times what `psi` lists (one a line).
std::string scaled_text(const ScaledModel& model, double scale) {
  std::string text = "[model]\nname = \"degenerate\"\n[states]\n" + model.states + "[switching]\n";
  int number = 0;
  for (std::size_t begin = 0; begin < model.psi.size();) {
    const std::size_t end = model.psi.find('\n', begin);
    text += fmt::format("s{} = \"{}*({})\"\n", ++number, scale, model.psi.substr(begin, end - begin));
    begin = end + 1;
  }
  return text + "[dynamics]\n" + model.dynamics + "[simulate]\n" + model.simulate;
}

template <class Check>
void in_every_scale(const ScaledModel& model, const Check& check) {
  for (const double scale : {1.0, 1e8, 1e-8}) {
    for (const Accuracy& accuracy : {fine, standard, implicit})
      check(simulate_text(scaled_text(model, scale), accuracy));
  }
}

void expect_completed(const Result& result) {
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
}

// y' = (1, -2 t) below, towards y2 = 0 above: y2 = -t^2 touches the surface at t = 0 and returns.
TEST(Degenerate, GrazingIsNoSwitch) {
  const ScaledModel model{"y1 = -1\ny2 = -1\n", "y2\n", "y1 = \"1\"\ny2 = \"if(s1 > 0, -3, -2*t)\"\n",
                          "from = -1\nuntil = 1\n"};
  in_every_scale(model, [](const Result& result) {
    expect_completed(result);
    for (const Event& event : result.events) EXPECT_EQ(event.mode_after, (std::vector<int>{-1})) << event.t;
    EXPECT_EQ(result.final.mode, (std::vector<int>{-1}));
    EXPECT_NEAR(result.final.x[1], -1.0, 1e-9);
  });
}

// The same with a shift of 1e-6 across the surface: |t| < 1e-3 is above it, where the field leads on.
TEST(Degenerate, AShallowPassageIsTwoSwitches) {
  const ScaledModel model{"y1 = -1\ny2 = -0.999999\n", "y2\n", "y1 = \"if(s1 > 0, 2, 1)\"\ny2 = \"-2*t\"\n",
                          "from = -1\nuntil = 1\n"};
  in_every_scale(model, [](const Result& result) {
    expect_completed(result);
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_NEAR(result.events[0].t, -1e-3, 1e-6);
    EXPECT_NEAR(result.events[1].t, 1e-3, 1e-6);
    EXPECT_NEAR(result.final.x[0], 1.0 + 2e-3, 1e-6);
  });
}

// Two surfaces at the same time are one event, 1e-9 apart they are two.
TEST(Degenerate, SurfacesMetTogetherAreOneEvent) {
  for (const double apart : {0.0, 1e-9, 1e-6}) {
    const ScaledModel model{"y1 = 0\ny2 = 0\ny3 = 0\n", fmt::format("y1 - 0.5\ny2 - 0.5 - {}\n", apart),
                            "y1 = \"1\"\ny2 = \"1\"\ny3 = \"step(s1) + 2*step(s2)\"\n", "until = 1\n"};
    in_every_scale(model, [apart](const Result& result) {
      expect_completed(result);
      ASSERT_EQ(result.events.size(), apart == 0.0 ? 1U : 2U);
      EXPECT_NEAR(result.events[0].t, 0.5, 1e-14);
      EXPECT_NEAR(result.events.back().t, 0.5 + apart, 1e-14);
      EXPECT_EQ(result.events.back().mode_after, (std::vector<int>{1, 1}));
      EXPECT_NEAR(result.final.x[2], 0.5 + 2 * (0.5 - apart), 1e-12);
    });
  }
}

// psi stays 0 from the start: without consequence where the fields agree, outside the class where they differ.
TEST(Degenerate, PsiThatStaysZeroIsSaidWhereItMatters) {
  in_every_scale({"x = 0\ny = 0\n", "y\n", "x = \"1\"\ny = \"y*sign(s1)\"\n", "until = 1\n"}, [](const Result& result) {
    expect_completed(result);
    EXPECT_NEAR(result.final.x[0], 1.0, 1e-14);
    EXPECT_EQ(result.final.x[1], 0.0);
  });
  in_every_scale({"x = 0\ny = 0\n", "y\n", "x = \"sign(s1)\"\ny = \"0*x\"\n", "until = 1\n"}, [](const Result& result) {
    EXPECT_EQ(result.status.termination, Termination::outside_class) << result.status.message;
  });
}

// lambda = 1 - (t - 1)^2 touches 1: the solution slides on.
TEST(Degenerate, ASelectionThatTouchesItsBoundSlidesOn) {
  in_every_scale({"x = 0\n", "x\n", "x = \"1 - (t - 1)^2 - sign(s1)\"\n", "until = 1.9\n"}, [](const Result& result) {
    expect_completed(result);
    for (const Event& event : result.events) EXPECT_EQ(event.mode_after, (std::vector<int>{0})) << event.t;
    EXPECT_EQ(result.final.x[0], 0.0);
    EXPECT_NEAR(result.final.alpha[0], 1.0 - 0.81 / 2, 1e-12);
  });
}

// lambda = 1 + (t - 1)^3 passes 1 with slope 0: x = (t - 1)^4/4 behind.
TEST(Degenerate, ASelectionThatLeavesItsBoundFlatLeaves) {
  in_every_scale({"x = 0\n", "x\n", "x = \"1 + (t - 1)^3 - sign(s1)\"\n", "until = 2\n"}, [](const Result& result) {
    expect_completed(result);
    const auto switches = switches_of(result);
    ASSERT_EQ(switches.size(), 1U);
    EXPECT_EQ(switches[0].kind, EventKind::leave_sliding);
    // A triple zero is as good as the cube root of its rounding.
    EXPECT_NEAR(switches[0].t, 1.0, 1e-4);
    EXPECT_NEAR(result.final.x[0], 0.25, 1e-8);
  });
}

/// Stick-slip on one belt, backwards in time, on the belt.
ScaledModel stick_slip_reversed(const std::string& more) {
  return {"x1 = 0.5\nx2 = 0.2\n", "x2 - 0.2\n", "x1 = \"-x2\"\nx2 = \"x1 - if(s1 > 0, -1/(0.8 + x2), 1/(1.2 - x2))\"\n",
          "until = 7.6\n" + more};
}

// Backwards the belt repels: from each of its points the solution can leave.
TEST(Degenerate, ReversedSlidingRepelsAndIsNotUnique) {
  in_every_scale(stick_slip_reversed(""), [](const Result& result) {
    ASSERT_GE(result.events.size(), 1U);
    EXPECT_EQ(result.events[0].kind, EventKind::start);
    EXPECT_EQ(result.events[0].unique, false);
    EXPECT_EQ(result.events[0].mode_after, (std::vector<int>{1}));
    EXPECT_EQ(result.events[0].alternatives.size(), 2U);
  });
}

// Forced to stay it slides until the upper field is tangent: x1 = 0.5 - 0.2 t = -1 at t = 7.5.
TEST(Degenerate, ForcedReversedSlidingEndsWhereItsFieldIsTangent) {
  in_every_scale(stick_slip_reversed("initial_mode = { s1 = 0 }\n"), [](const Result& result) {
    expect_completed(result);
    const auto switches = switches_of(result);
    ASSERT_GE(switches.size(), 1U);
    EXPECT_NEAR(switches[0].t, 7.5, 1e-9);
    EXPECT_NEAR(switches[0].x[0], -1.0, 1e-9);
    EXPECT_EQ(switches[0].x[1], 0.2);
  });
}

// The relay backwards from just before its first exit, forced to slide: it comes back to where it started.
TEST(Degenerate, TheRelayRunsBackwardsAlongItsSliding) {
  const auto relay = [](double sign, const std::string& states, const std::string& more) {
    // omega = 25, xi = 0.05.
    return ScaledModel{
        states, "x1\n",
        fmt::format("x1 = \"{0}*(-3.5*x1 + x2 - sign(s1))\"\nx2 = \"{0}*(-627.5*x1 + x3 + 2*sign(s1))\"\n"
                    "x3 = \"{0}*(-625*x1 - sign(s1))\"\n",
                    sign),
        "until = 2.8\n" + more};
  };
  for (const Accuracy& accuracy : {fine, Accuracy{pipeline::Integrator::radau5, 1e-12, 1e-14}}) {
    const Result forth = simulate_text(scaled_text(relay(1.0, "x1 = 0\nx2 = -0.001\nx3 = -0.02\n", ""), 1.0), accuracy);
    expect_completed(forth);
    ASSERT_EQ(forth.final.mode, (std::vector<int>{0}));
    const std::string states = fmt::format("x1 = 0\nx2 = {:.17g}\nx3 = {:.17g}\n", forth.final.x[1], forth.final.x[2]);
    const Result back = simulate_text(scaled_text(relay(-1.0, states, "initial_mode = { s1 = 0 }\n"), 1.0), accuracy);
    expect_completed(back);
    EXPECT_TRUE(switches_of(back).empty());
    EXPECT_EQ(back.final.x[0], 0.0);
    // Sliding is a growing oscillation; backwards errors shrink.
    EXPECT_NEAR(back.final.x[1], -0.001, 1e-9);
    EXPECT_NEAR(back.final.x[2], -0.02, 1e-9);
  }
}

/// Two belts, one behind the other, forwards (1) or backwards (-1) in time.
ScaledModel belts(double sign, const std::vector<double>& x, const std::string& simulate) {
  return {fmt::format("x1 = {:.17g}\nx2 = {:.17g}\nx3 = {:.17g}\n", x[0], x[1], x[2]), "x2 - 0.2\nx3 - 0.4\n",
          fmt::format("x1 = \"{0}*((x2 + x3)/2 + x1*(x2 + 0.8)*(x3 + 0.6)*step(s1)*step(s2))\"\n"
                      "x2 = \"{0}*(-x1 + if(s1 > 0, -1/(0.8 + x2), 1/(1.2 - x2)))\"\n"
                      "x3 = \"{0}*(-x1 + if(s2 > 0, -1/(0.6 + x3), 1/(1.4 - x3)))\"\n",
                      sign),
          simulate};
}

/// Time in which sliding on both belts takes x1 from `from` to `to`: x1' = 0.3 + x1 (1 - x1)^2/4. Simpson's rule.
double dwell(double from, double to) {
  constexpr int halves = 2000;
  const double h = (to - from) / (2 * halves);
  double sum = 0.0;
  for (int i = 0; i <= 2 * halves; ++i) {
    const double x = from + i * h;
    const double weight = i == 0 || i == 2 * halves ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight / (0.3 + x * (1 - x) * (1 - x) / 4);
  }
  return sum * h / 3;
}

// Backwards both belts repel. Forced to stay on both the solution goes back along the sliding.
TEST(Degenerate, BothBeltsReversedAreSlidOnBackwards) {
  in_every_scale(belts(-1, {0.8, 0.2, 0.4}, "until = 4\ninitial_mode = { s1 = 0, s2 = 0 }\n"),
                 [](const Result& result) {
                   expect_completed(result);
                   EXPECT_TRUE(switches_of(result).empty());
                   EXPECT_EQ(result.events.front().unique, false);
                   EXPECT_EQ(result.final.mode, (std::vector<int>{0, 0}));
                   EXPECT_NEAR(dwell(result.final.x[0], 0.8), 4.0, 1e-6);
                   EXPECT_NEAR(result.final.alpha[0], (1 - result.final.x[0]) / 2, 1e-12);
                   EXPECT_NEAR(result.final.alpha[1], (1 - result.final.x[0]) / 2, 1e-12);
                   EXPECT_EQ(result.final.x[1], 0.2);
                   EXPECT_EQ(result.final.x[2], 0.4);
                 });
}

// Not forced it leaves both; the other motions leave one of them, or both to other sides.
TEST(Degenerate, BothBeltsReversedCanBeLeftAnywhere) {
  in_every_scale(belts(-1, {0.8, 0.2, 0.4}, "until = 1\n"), [](const Result& result) {
    expect_completed(result);
    ASSERT_EQ(result.events.size(), 1U);
    EXPECT_EQ(result.events[0].unique, false);
    EXPECT_EQ(result.final.mode, (std::vector<int>{1, 1}));
    EXPECT_GE(result.events[0].alternatives.size(), 4U);
  });
}

// Backwards along the slip up to just before the corner where both belts were left at 3.2542.
TEST(Degenerate, TheSlipOfBothBeltsRunsBackwards) {
  const std::vector<double> start{0.04, -0.01, -0.02};
  for (const Accuracy& accuracy : {fine, Accuracy{pipeline::Integrator::radau5, 1e-12, 1e-14}}) {
    const Result near_corner = simulate_text(scaled_text(belts(1, start, "until = 3.255\n"), 1.0), accuracy);
    const Result later = simulate_text(scaled_text(belts(1, start, "until = 7\n"), 1.0), accuracy);
    const Result back = simulate_text(scaled_text(belts(-1, later.final.x, "until = 3.745\n"), 1.0), accuracy);
    expect_completed(back);
    EXPECT_TRUE(switches_of(back).empty());
    EXPECT_EQ(back.final.mode, (std::vector<int>{-1, -1}));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back.final.x[i], near_corner.final.x[i], 1e-10) << i;
  }
}

}  // namespace
}  // namespace saltus::problems
