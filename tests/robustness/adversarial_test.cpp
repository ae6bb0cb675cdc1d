// Models made to do evil: whatever they do to steps, events and decisions, the run ends with a status and its reason.
#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

constexpr long most_steps = 20000;
constexpr long most_events = 2000;

/// x' = f, t from 0 to 2.
struct Evil {
  std::string_view name;
  double start;
  std::string_view f;
};

constexpr Evil evils[] = {
    {"blow_up_behind_a_switch", 0.5, "x^2 + sign(x - 1)"},
    {"undefined_beyond_its_surface", 1.0, "-1 + 0.5*sign(sqrt(x) - 0.5*x)"},
    {"undefined_field_on_one_side", 1.0, "if(x > 0, -1, sqrt(x))"},
    {"field_of_1e300", 0.0, "1e300*sign(1 - x)"},
    {"overflowing_field", 1.0, "1e300*x*(1 + sign(x - 1e10))"},
    {"denormal_state", 1e-310, "-1e-310*sign(x)"},
    {"zero_field_on_a_surface", 0.0, "max(x, 0)"},
    {"zero_field_in_front_of_a_surface", 0.0, "x*sign(x)"},
    {"not_lipschitz_on_its_surface", 1.0, "-sign(x)*sqrt(abs(x))"},
    {"infinite_slope_at_its_surface", 1.0, "-sign(x)/sqrt(abs(x))"},
    {"cubed_switching_function", 1.0, "-sign((x - 0.5)^3)"},
    {"squared_switching_function", 1.0, "-1 - 0.5*sign((x - 0.5)^2)"},
    {"jumping_switching_function", 0.0, "sign(x - 0.1*sign(sin(40*t)))"},
    {"switches_that_accumulate", 0.0, "sign(sin(1/(1.5 - t)))"},
    {"switches_faster_than_time_is_resolved", 0.0, "sign(sin(1e15*t))"},
    {"pole_in_a_switching_function", 0.0, "1 + 0.5*sign(1/(x - 1))"},
    {"infinite_switching_function", 1.0, "-sign(exp(1000*x) - 2)"},
    {"relay_against_itself", 0.0, "sign(x)"},
};

class AdversarialModels : public testing::TestWithParam<Evil> {};

TEST_P(AdversarialModels, EndWithAStatusAndItsReason) {
  const Evil& evil = GetParam();
  const std::string text = "[model]\nname = \"evil\"\n[states]\nx = 0\n[dynamics]\nx = \"" + std::string(evil.f) +
                           "\"\n[simulate]\nuntil = 2.0\n";
  Simulator model = Simulator::from_text(text);
  model.set_initial_state({evil.start});
  for (const auto integrator : {pipeline::Integrator::dopri5, pipeline::Integrator::dop853,
                                pipeline::Integrator::radau5, pipeline::Integrator::taylor}) {
    pipeline::SimulateOptions options = with(model.options(), {integrator, 1e-8, 1e-10});
    options.max_steps = most_steps;
    options.max_events = most_events;
    const result::Result result = model.run(options);
    const auto& status = result.status;
    if (status.termination != result::Termination::completed) {
      EXPECT_FALSE(status.message.empty()) << result::name(status.termination);
    } else {
      ASSERT_FALSE(result.final.x.empty());
      EXPECT_TRUE(std::isfinite(result.final.x[0]));
      EXPECT_EQ(result.final.t, 2.0);
    }
    EXPECT_TRUE(status.time_reached >= 0.0 && status.time_reached <= 2.0) << status.time_reached;
    EXPECT_LE(static_cast<long>(result.events.size()), most_events + 8);
    // A limit of steps counts those that were taken; each may be tried anew, but not for ever.
    EXPECT_LE(result.statistics.steps + result.statistics.rejected, 60 * most_steps);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, AdversarialModels, testing::ValuesIn(evils),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace saltus::problems
