// Starts where a field is tangent to the surface: the first derivative of psi along it that does not vanish says where
// it goes, and where none does psi stays at zero. Both engines name it alike.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

struct Tangency {
  const char* what;
  const char* below_x;
  const char* above_x;
  const char* above_y;
  int mode;
  std::vector<int> alternatives;
  double final_x;  ///< at t = 1/2
};

/// From x = y = 0, where the field above is tangent to x = 0.
const std::vector<Tangency> tangencies{
    {"stays, and is pressed on: the surface is slid on with its field", "1", "0", "1", 0, {}, 0.0},
    {"stays, and is not pressed on", "-1", "0", "1", -1, {0}, -0.5},
    {"bends away from it", "1", "y", "1", 1, {}, 0.125},
    {"bends back to it", "1", "y", "-1", 0, {}, 0.0},
    {"bends back to it, and is left below", "-1", "y", "-1", -1, {}, -0.5},
    {"leaves like t^3", "1", "3*y^2", "1", 1, {}, 0.125},
    {"returns like t^3", "1", "-3*y^2", "1", 0, {}, 0.0},
    {"returns like t^3, and is left below", "-1", "-3*y^2", "1", -1, {}, -0.5},
    {"leaves like t^3, or stays, or is left below", "-1", "3*y^2", "1", 1, {-1, 0}, 0.125},
};

void expect_named(const result::Result& result, const Tangency& tangency) {
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  ASSERT_FALSE(result.events.empty());
  const auto& start = result.events.front();
  EXPECT_EQ(start.kind, result::EventKind::start);
  EXPECT_EQ(*start.mode_after, (std::vector<int>{tangency.mode}));
  EXPECT_EQ(start.unique, std::optional(tangency.alternatives.empty()));
  std::vector<int> others;
  for (const auto& alternative : start.alternatives) others.push_back(alternative.mode.front());
  std::sort(others.begin(), others.end());
  EXPECT_EQ(others, tangency.alternatives);
  EXPECT_EQ(result.events.size(), 1U);
  EXPECT_NEAR(result.final.x[0], tangency.final_x, 1e-7);
}

TEST(TangentStart, BothEnginesNameItAlike) {
  for (const Tangency& tangency : tangencies) {
    for (const double scale : {1.0, 1e8, 1e-8}) {
      for (const bool mirrored : {false, true}) {
        SCOPED_TRACE(fmt::format("{}, psi times {}{}", tangency.what, scale, mirrored ? ", mirrored" : ""));
        const Simulator simulator = Simulator::from_text(fmt::format(
            R"toml(
[model]
name = "tangent"
[states]
x = 0
y = 0
[switching]
s = "{}*x"
[dynamics]
x = "{}*if({} > 0, {}, {})"
y = "if({} > 0, {}, 1)"
[simulate]
until = 0.5
)toml",
            scale, mirrored ? -1 : 1, mirrored ? "-s" : "s", tangency.above_x, tangency.below_x, mirrored ? "-s" : "s",
            tangency.above_y));
        Tangency expected = tangency;
        if (mirrored) {
          expected.mode = -expected.mode;
          for (int& other : expected.alternatives) other = -other;
          std::sort(expected.alternatives.begin(), expected.alternatives.end());
          // Of two sides that are left to, that of psi > 0 is taken.
          if (expected.alternatives.size() == 2) {
            expected.mode = 1;
            expected.alternatives = {-1, 0};
            expected.final_x = 0.5;
          } else {
            expected.final_x = -expected.final_x;
          }
        }
        expect_named(simulator.run(simulator.options()), expected);
        auto options = simulator.options();
        options.method = pipeline::Method::fesd;
        expect_named(simulator.run(options), expected);
      }
    }
  }
}

// x' = -sqrt(2 |x|) sign(x) + 2 t from 0, or the same about 1 and downwards: x = +-t^2/2, also where the solution
// slides up to t = 1 and leaves then.
TEST(TangentStart, ARootIsLeft) {
  struct Case {
    const char* what;
    const char* field;
    double rest;
  };
  for (const Case& c : {Case{"start", "-sqrt(2*abs(s))*sign(s) + {}*2*t", 0.0},
                        Case{"exit", "if({0}*s > 0, -{0}*sqrt(2*abs(s)) + {0}*2*(t - 1), {0})", 1.0}}) {
    for (const int side : {1, -1}) {
      for (const double level : {0.0, 1.0}) {
        SCOPED_TRACE(fmt::format("{}, side {}, level {}", c.what, side, level));
        const Simulator simulator =
            Simulator::from_text(fmt::format(R"toml(
[model]
name = "root"
[states]
x = {}
[switching]
s = "x - {}"
[dynamics]
x = "{}"
[simulate]
until = {}
)toml",
                                             level, level, fmt::format(fmt::runtime(c.field), side), c.rest + 2.0));
        for (const auto& accuracy : {fine, standard, implicit}) {
          const auto result = simulator.run(with(simulator.options(), accuracy));
          ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
          // Roundings of x near 1 are 1e-8 in its root, where the solution leaves; it forgets them like 1/t.
          const double rounding = level == 0.0 ? 0.0 : 1e-9;
          EXPECT_NEAR(result.final.x[0], level + side * 2.0, rounding + 3.0 * accuracy.rtol);
        }
        auto options = simulator.options();
        options.method = pipeline::Method::fesd;
        const auto result = simulator.run(options);
        ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
        // Collocation in the root of time has this solution but for roundings.
        EXPECT_NEAR(result.final.x[0], level + side * 2.0, 1e-8);
        EXPECT_LT(result.statistics.steps, 1000);
      }
    }
  }
}

// Sliding on a ends at t = 0.98, where sign(b) = 0.2; behind it x = (t - 0.98)^2/4, while b is slid on.
TEST(TangentStart, ARootIsLeftWhileAnotherSurfaceIsSlidOn) {
  const Simulator simulator = Simulator::from_text(R"toml(
[model]
name = "root and another surface"
[states]
x = 0
y = 0
[switching]
a = "x"
b = "y"
[dynamics]
x = "-sign(a) - sqrt(abs(a))*sign(a) + t + 0.1*sign(b)"
y = "-sign(b) + 0.3*sign(a) - 0.1"
[simulate]
until = 3
)toml");
  for (const auto& accuracy : {fine, standard}) {
    const auto result = simulator.run(with(simulator.options(), accuracy));
    ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_NEAR(result.events[1].t, 0.98, 1e-12);
    EXPECT_EQ(*result.events[1].mode_after, (std::vector<int>{1, 0}));
    // The error of x decays, as the solution is stiff; it is that of some steps.
    EXPECT_NEAR(result.final.x[0], 1.0201, 3.0 * accuracy.rtol);
    EXPECT_EQ(result.final.x[1], 0.0);
  }
}

}  // namespace
}  // namespace saltus::problems
