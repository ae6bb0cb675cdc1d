// Surfaces that meet where some of them do not depend on the others: who depends on nobody is decided first. Closed
// forms.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::EventKind;
using result::Result;
using result::Termination;

template <class Check>
void in_every_integrator(const std::string& text, const Check& check) {
  for (const Accuracy& accuracy : {fine, standard, implicit}) {
    const Simulator simulator = Simulator::from_text(text);
    const Result result = simulator.run(with(simulator.options(), accuracy));
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    check(result);
  }
}

// A mass w at rest on dry friction, a backlash of 1/6 on either side of d = v - w; everything is zero at the start. w
// sticks; d = t^3/6 moves to third order only, and how depends on w. Contact at t = 1; the spring overcomes the
// friction where 0.3 (t^3 - 1)/6 = 0.05.
TEST(Influence, ABacklashAndFrictionAtRest) {
  in_every_integrator(R"toml(
[model]
name = "backlash"
[states]
d = 0
v = 0
w = 0
[definitions]
spring = "if(abs(d) > 1/6, 0.3*(d - sign(d)/6), 0)"
[dynamics]
d = "v - w"
v = "t"
w = "spring - 0.05*sign(w)"
[simulate]
until = 1.3
)toml",
                      [](const Result& result) {
                        const auto leaves = switches_of(result);
                        ASSERT_EQ(leaves.size(), 1U);
                        EXPECT_EQ(leaves[0].kind, EventKind::leave_sliding);
                        EXPECT_NEAR(leaves[0].t, std::cbrt(2.0), 1e-8);
                        EXPECT_NEAR(leaves[0].x[0], 1.0 / 3.0, 1e-8);
                      });
}

// Three regions meet on x = 0 while z slides on z = x/5, which depends on them and which they do not depend on. A and B
// meet from t = 1 on with weights 4/9 and 5/9, C joins them at y = -5/12, where all three hold the solution.
TEST(Influence, ASurfaceThatFeelsRegionsWhereTheyMeet) {
  in_every_integrator(R"toml(
[model]
name = "regions"
[states]
x = 1
y = 0.5
z = 0
[[modes]]
name = "A"
indicator = "(x - 1)^2 + y^2"
dynamics = { x = "-1", y = "-0.5" }
[[modes]]
name = "B"
indicator = "(x + 1)^2 + y^2"
dynamics = { x = "0.8", y = "-0.3" }
[[modes]]
name = "C"
indicator = "x^2 + (y + 1.5)^2"
dynamics = { x = "0.1", y = "1" }
[dynamics]
z = "0.1 - sign(z - 0.2*x)"
[simulate]
until = 3
)toml",
                      [](const Result& result) {
                        const auto switches = switches_of(result);
                        ASSERT_EQ(switches.size(), 3U);
                        EXPECT_NEAR(switches[0].t, 2.0 / 13.0, 1e-9);
                        EXPECT_NEAR(switches[1].t, 1.0, 1e-9);
                        EXPECT_NEAR(switches[2].t, 1.0 + 15.0 / 14.0, 1e-9);
                        EXPECT_EQ(switches[2].surfaces, (std::vector<std::string>{"C"}));
                        EXPECT_NEAR(result.final.x[0], 0.0, 1e-9);
                        EXPECT_NEAR(result.final.x[1], -5.0 / 12.0, 1e-9);
                        EXPECT_NEAR(result.final.x[2], 0.0, 1e-9);
                        EXPECT_NEAR(result.final.alpha.at(0), 0.55, 1e-9);
                      });
}

// x, y and z are slid on with sign(y) = 0.2, sign(x) = -0.04 and sign(z) = 0.6 t - 0.132, or minus that. At
// t = 1.132/0.6 z leaves, x and y go on.
TEST(Influence, OfThreeSurfacesOneIsLeft) {
  const double leaves = 1.132 / 0.6, end = 0.3 * (16.0 - leaves * leaves) - 1.132 * (4.0 - leaves);
  for (const bool up : {true, false}) {
    const std::string x = "x = \"0.1 - sign(x) - 0.7*sign(y)\"\n", y = "y = \"0.2 - sign(y)\"\n",
                      z = up ? "z = \"0.6*t - sign(z) - 0.66*sign(y)\"\n" : "z = \"-0.6*t - sign(z) + 0.66*sign(y)\"\n";
    for (const std::string& dynamics : {x + y + z, z + y + x, y + z + x}) {
      SCOPED_TRACE(dynamics);
      in_every_integrator("[model]\nname = \"three\"\n[states]\nx = 0.1\ny = 0.2\nz = -0.3\n[dynamics]\n" + dynamics +
                              "[simulate]\nuntil = 4\n",
                          [&](const Result& result) {
                            const auto switches = switches_of(result);
                            ASSERT_FALSE(switches.empty());
                            EXPECT_EQ(switches.back().kind, EventKind::leave_sliding);
                            EXPECT_EQ(switches.back().unique, true);
                            EXPECT_NEAR(switches.back().t, leaves, 1e-9);
                            EXPECT_EQ(result.final.x[0], 0.0);
                            EXPECT_EQ(result.final.x[1], 0.0);
                            EXPECT_NEAR(result.final.x[2], up ? end : -end, 1e-8);
                          });
    }
  }
}

}  // namespace
}  // namespace saltus::problems
