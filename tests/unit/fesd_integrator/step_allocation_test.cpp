// No memory is allocated from simulation step to simulation step between switches.
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;
using saltus::tests::allocations;

struct Count {
  long steps = 0;            ///< from one step without switch to the next
  long with_allocation = 0;  ///< of them
};

/// A block on a belt: slips, and sticks (slides on v = 0.2).
model::System stick_slip() {
  model::Builder builder("stick-slip");
  const SX q = builder.state("q", {0.04});
  const SX v = builder.state("v", {-0.01});
  const SX ahead = builder.step(v - 0.2);
  builder.dynamics("q", v);
  builder.dynamics("v", -q + (1.0 - ahead) / (1.2 - v) - ahead / (0.8 + v));
  return *builder.build();
}

Count count(TableauFamily family, Form form, IntegrationOptions::Switches switches) {
  const auto system = stick_slip();
  const auto dcs = reformulation::reformulate(system, {form, std::nullopt});
  EXPECT_TRUE(dcs.has_value());
  IntegrationOptions options;
  options.switches = switches;
  options.tableau = *discretization::butcher_tableau(family, 3);
  options.until = 12.0;
  options.steps = 300;
  options.rows = IntegrationOptions::Rows::at_times;  // rows are kept, and so need memory
  Count count;
  long seen = -1, events = -1, quiet = 0;
  const auto observer = [&](const Progress& progress) {
    // The first two steps of a mode fill what later ones use again.
    quiet = progress.events == events ? quiet + 1 : 0;
    if (quiet > 2 && progress.t < options.until) {
      ++count.steps;
      count.with_allocation += allocations != seen ? 1 : 0;
    }
    events = progress.events;
    seen = allocations;
    return result::Continue::yes;
  };
  const auto integration = integrate(system, *dcs, options, observer);
  EXPECT_EQ(integration->status.termination, result::Termination::completed) << integration->status.message;
  EXPECT_GE(events, 3);
  return count;
}

TEST(StepAllocation, NoneBetweenSwitches) {
  for (const auto form : {Form::step, Form::stewart}) {
    for (const auto family : {TableauFamily::radau_iia, TableauFamily::gauss_legendre, TableauFamily::lobatto_iiia,
                              TableauFamily::lobatto_iiic, TableauFamily::explicit_rk}) {
      const auto steps = count(family, form, IntegrationOptions::Switches::detected);
      EXPECT_GT(steps.steps, 200) << static_cast<int>(family);
      EXPECT_EQ(steps.with_allocation, 0) << static_cast<int>(family);
    }
  }
}

TEST(StepAllocation, NoneWithoutSwitchDetection) {
  for (const auto form : {Form::step, Form::stewart}) {
    const auto steps = count(TableauFamily::radau_iia, form, IntegrationOptions::Switches::fixed);
    EXPECT_GT(steps.steps, 200);
    EXPECT_EQ(steps.with_allocation, 0);
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
