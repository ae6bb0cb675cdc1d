// Ideal plasticity as it is written down: a force that stays at its bound while the velocity would carry it beyond, by
// a condition of both. Unloading begins where the velocity passes 0, a kink, and sliding on the bound ends, at one
// time.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

// The velocity is given, v = sin(t): from F = 0 the force F' = 4 v is at 1 when 4 (1 - cos t) = 1, unloads from t = pi
// on, and is at -1 when 1 - 4 (1 + cos t) = -1. From there on it is periodic.
TEST(Elastoplastic, UnloadsWhereTheVelocityTurns) {
  constexpr double pi = std::numbers::pi;
  const double up = std::acos(0.75), down = pi + std::acos(0.5);  // 1 - cos(t - pi) = 1/2
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(R"toml(
[states]
x = -1
v = 0
F = 0
[dynamics]
x = "v"
v = "-x"
F = "if((F >= 1 and v > 0) or (F <= -1 and v < 0), 0, 4*v)"
[simulate]
until = 100
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    std::vector<double> times = {up, pi};
    for (int k = 1; static_cast<double>(k) * pi < 100; ++k) {
      const double turned = k * pi;
      if (turned + std::acos(0.5) < 100) times.push_back(turned + down - pi);
      if (turned + pi < 100) times.push_back(turned + pi);
    }
    // Rates of a period that add up.
    expect_times(result.events, times, 100 * 100 * accuracy.rtol);
  }
}

}  // namespace
}  // namespace saltus::problems
