// Restarts from the state behind an event: what follows is what followed in the whole simulation.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/consistency.hpp"
#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::Result;

const char* const models[] = {"crossing",
                              "two-lines",
                              "rotating-oscillator",
                              "dry-friction-oscillator",
                              "stick-slip",
                              "relay-feedback",
                              "relay-oscillator",
                              "friction-blocks",
                              "half-plane",
                              "sweeping-disc",
                              "circle",
                              "stick-slip-from-outside",
                              "sliding",
                              "leaving-sliding",
                              "irma"};

class Restarts : public testing::TestWithParam<const char*> {};

TEST_P(Restarts, FromTheStateBehindAnEventTheNextEventsFollow) {
  const ReferenceProblem& problem = reference(GetParam());
  Simulator model = Simulator::from_reference(problem);
  const pipeline::SimulateOptions options = with(model.options(), fine);
  const Result whole = model.run(options);
  ASSERT_EQ(whole.status.termination, result::Termination::completed) << whole.status.message;
  ASSERT_EQ(whole.events.size(), problem.events.size());
  for (std::size_t i = 0; i < whole.events.size(); ++i) {
    SCOPED_TRACE("restart from event " + std::to_string(i + 1));
    pipeline::SimulateOptions rest = options;
    rest.from = whole.events[i].t;
    model.set_initial_state(whole.events[i].x_after);
    const Result result = model.run(rest);
    EXPECT_EQ(complaint(result), "");
    // x_after is on the surface up to rounding: what happens within an instant belongs to the start
    std::vector<Event> found = switches_of(result);
    std::erase_if(found, [&](const Event& event) { return event.t - rest.from < instant; });
    ASSERT_EQ(found.size(), whole.events.size() - i - 1);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].kind, whole.events[i + 1 + k].kind);
      EXPECT_EQ(found[k].mode_after, whole.events[i + 1 + k].mode_after);
      EXPECT_NEAR(found[k].t, whole.events[i + 1 + k].t, 1e-8 * std::max(1.0, rest.from));
    }
    EXPECT_EQ(result.final.mode, whole.final.mode);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Restarts, testing::ValuesIn(models), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace saltus::problems
