// Catalogue models stated by [[modes]] instead of [dynamics]: the same solutions.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

void expect_same_motion(const result::Result& modes, const result::Result& text, double tolerance) {
  ASSERT_EQ(modes.status.termination, result::Termination::completed) << modes.status.message;
  ASSERT_EQ(modes.events.size(), text.events.size());
  for (std::size_t i = 0; i < text.events.size(); ++i) {
    EXPECT_EQ(modes.events[i].kind, text.events[i].kind) << "event " << i + 1;
    EXPECT_EQ(modes.events[i].mode_after, text.events[i].mode_after) << "event " << i + 1;
    EXPECT_NEAR(modes.events[i].t, text.events[i].t, tolerance * std::max(1.0, text.events[i].t)) << "event " << i + 1;
  }
  ASSERT_EQ(modes.final.x.size(), text.final.x.size());
  for (std::size_t i = 0; i < text.final.x.size(); ++i) {
    EXPECT_NEAR(modes.final.x[i], text.final.x[i], tolerance) << "component " << i + 1;
  }
}

TEST(ModesForm, TheRotatingOscillatorIsTheSameToTheBit) {
  const Simulator text = Simulator::from_catalogue("rotating-oscillator");
  const Simulator modes = Simulator::from_text(R"toml([model]
name = "rotating-oscillator"
[parameters]
omega = "2*pi"
[states]
x1 = "exp(-1)"
x2 = 0
[[modes]]
when = "x1^2 + x2^2 > 1"
dynamics = { x1 = "x1 - -omega*x2", x2 = "-omega*x1 + x2" }
[[modes]]
when = "otherwise"
dynamics = { x1 = "x1 - omega*x2", x2 = "omega*x1 + x2" }
[simulate]
until = 1.5707963267948966
output = { points = 401 }
)toml");
  expect_same_motion(modes.run(modes.options()), text.run(text.options()), 0.0);
}

// A group per gene; the decay stays in [dynamics]. A sum in another order rounds differently, and the flow damps that.
TEST(ModesForm, IrmaIsTheSame) {
  const Simulator text = Simulator::from_catalogue("irma");
  const Simulator modes = Simulator::from_text(R"toml([model]
name = "irma"
[states]
x1 = 0.011
x2 = 0.09
x3 = 0.04
x4 = 0.05
x5 = 0.015
[switching]
gal4 = "x1 - 0.01"
swi5_low = "x2 - 0.01"
swi5_mid = "x2 - 0.06"
swi5_high = "x2 - 0.08"
ash1 = "x3 - 0.035"
cbf1 = "x4 - 0.04"
gal80 = "x5 - 0.01"
[dynamics]
x1 = "-0.05*x1"
x2 = "-0.04*x2"
x3 = "-0.05*x3"
x4 = "-0.02*x4"
x5 = "-0.6*x5"
[[modes]]
group = "gal4"
when = "cbf1 > 0"
dynamics = { x1 = "1.1e-4 + 9e-4" }
[[modes]]
group = "gal4"
when = "cbf1 < 0"
dynamics = { x1 = "1.1e-4" }
[[modes]]
group = "swi5"
when = "gal4 > 0"
dynamics = { x2 = "3e-4 + 0.15" }
[[modes]]
group = "swi5"
when = "otherwise"
dynamics = { x2 = "3e-4" }
[[modes]]
group = "levels"                     # x2 alone decides: three thresholds, four levels
when = "swi5_high > 0 and ash1 < 0"
dynamics = { x3 = "6e-4 + 0.018", x4 = "5e-4 + 0.03", x5 = "7.5e-4 + 0.015" }
[[modes]]
group = "levels"
when = "swi5_high > 0 and ash1 > 0"
dynamics = { x3 = "6e-4 + 0.018", x4 = "5e-4", x5 = "7.5e-4 + 0.015" }
[[modes]]
group = "levels"
when = "swi5_high < 0 and swi5_mid > 0 and ash1 < 0"
dynamics = { x3 = "6e-4 + 0.018", x4 = "5e-4 + 0.03", x5 = "7.5e-4" }
[[modes]]
group = "levels"
when = "swi5_high < 0 and swi5_mid > 0 and ash1 > 0"
dynamics = { x3 = "6e-4 + 0.018", x4 = "5e-4", x5 = "7.5e-4" }
[[modes]]
group = "levels"
when = "swi5_mid < 0 and swi5_low > 0 and ash1 < 0"
dynamics = { x3 = "6e-4", x4 = "5e-4 + 0.03", x5 = "7.5e-4" }
[[modes]]
group = "levels"
when = "swi5_mid < 0 and swi5_low > 0 and ash1 > 0"
dynamics = { x3 = "6e-4", x4 = "5e-4", x5 = "7.5e-4" }
[[modes]]
group = "levels"
when = "swi5_low < 0"
dynamics = { x3 = "6e-4", x5 = "7.5e-4" }
[simulate]
until = 100.0
output = { points = 2001 }
)toml");
  pipeline::SimulateOptions options = with(text.options(), fine);
  options.until = 100.0;
  expect_same_motion(modes.run(options), text.run(options), 1e-12);
}

TEST(ModesForm, SlidingIsTheSame) {
  const Simulator text = Simulator::from_catalogue("dry-friction-oscillator");
  const Simulator modes = Simulator::from_text(R"toml([model]
name = "dry-friction-oscillator"
[states]
x = 3
v = 0
[dynamics]
x = "v"
v = "-x"
[[modes]]
group = "friction"
when = "v > 0"
dynamics = { v = "-0.4" }
[[modes]]
group = "friction"
when = "v < 0"
dynamics = { v = "0.4" }
[simulate]
until = 15.0
output = { points = 601 }
)toml");
  expect_same_motion(modes.run(modes.options()), text.run(text.options()), 1e-12);
}

}  // namespace
}  // namespace saltus::problems
