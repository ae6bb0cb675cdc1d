// Zeros of [[events]] at jumps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

// x touches 0 at every impact, at sqrt(2), 2 sqrt(2) and 2.5 sqrt(2), and never passes it.
TEST(JumpZeros, OfAFunctionThatTouchesZeroFireOnce) {
  for (const auto* guard : {"x", "sin(x)", "x*(2 + v^2)"}) {
    for (const auto& accuracy : {fine, standard, implicit}) {
      const Simulator simulator = Simulator::from_text(fmt::format(R"toml(
[model]
name = "touches"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-1"
[[jumps]]
when = "{}"
direction = "down"
set = {{ v = "-0.5*v" }}
[[events]]
name = "ground"
when = "x"
[simulate]
until = 3.7
)toml",
                                                                   guard));
      const Result result = simulator.run(with(simulator.options(), accuracy));
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      ASSERT_EQ(result.events.size(), 6U) << guard;
      for (std::size_t i = 0; i < 6; i += 2) {
        EXPECT_EQ(*result.events[i].name, "ground");
        EXPECT_EQ(*result.events[i + 1].name, "jump1");
        EXPECT_EQ(result.events[i].t, result.events[i + 1].t);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::problems
