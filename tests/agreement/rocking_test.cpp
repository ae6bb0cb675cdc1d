// Rocking blocks: impacts behind which the block goes on the same way, and which nothing but its own restoring moment
// brings to rest. References are closed forms.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

constexpr double rocking_rate = 2.0;
constexpr double slenderness = 0.25;

/// The slender block of Housner on ground with the acceleration `ground`, both in units of gravity; an impact takes a
/// part of the rate and does not turn it around.
std::string rocking_block(const std::string& th, const std::string& ground, double until) {
  return fmt::format(R"toml(
[states]
th = {}
w = 0
[dynamics]
th = "w"
w = "{}^2*(th - {}*sign(th) - ({}))"
[[jumps]]
name = "impact"
when = "th"
direction = "both"
set = {{ w = "0.7*w" }}
[simulate]
until = {}
)toml",
                     th, rocking_rate, slenderness, ground, until);
}

/// It leaves to th < 0 at t_0, when the ground accelerates with the slenderness and on by rate s:
/// th'' = p^2 (th - rate s), s = t - t_0.
void expect_tipped(const Result& result, double t_0, double rate, double rtol) {
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const double s = result.final.t - t_0;
  // Errors grow with exp(rocking_rate s), as the solution does.
  const double th = rate * (s - std::sinh(rocking_rate * s) / rocking_rate),
               w = rate * (1.0 - std::cosh(rocking_rate * s));
  EXPECT_NEAR(result.final.x[0], th, 100 * rtol * std::abs(th));
  EXPECT_NEAR(result.final.x[1], w, 100 * rtol * std::abs(w));
  const auto left = std::find_if(result.events.begin(), result.events.end(), [&](const auto& event) {
    return event.mode_after && (*event.mode_after)[0] == (rate > 0 ? -1 : 1) && event.t > t_0 - 0.5;
  });
  ASSERT_NE(left, result.events.end());
  EXPECT_NEAR(left->t, t_0, 1e-7);
  // Leaving, the guard departs from 0: one execution, at rest.
  EXPECT_LE(std::distance(left, result.events.end()), 2);
}

TEST(Rocking, ABlockAtRestIsTippedWhenTheGroundAcceleratesEnough) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    for (const double rate : {0.02, -0.02}) {
      const double t_0 = slenderness / std::abs(rate);
      const Result result = simulated(rocking_block("0", fmt::format("{}*t", rate), t_0 + 2), accuracy);
      expect_tipped(result, t_0, rate, accuracy.rtol);
    }
  }
}

TEST(Rocking, ABlockThatRocksComesToRestAndIsTipped) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    for (const double rate : {0.02, -0.02}) {
      const double t_0 = slenderness / std::abs(rate);
      const Result result = simulated(rocking_block("0.05", fmt::format("{}*t", rate), t_0 + 2), accuracy);
      ASSERT_EQ(limits_of(result).size(), 1U);
      expect_tipped(result, t_0, rate, accuracy.rtol);
    }
  }
}

}  // namespace
}  // namespace saltus::problems
