// Exits of sliding that are not affine, which are sampled along a step.
#include <cmath>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Termination;

TEST(SampledExit, BehindALongStepIsLocatedWithoutCuttingIt) {
  // A block that stands under a drive 0.5 t + 0.3 sin(t) < 1: no state changes, so that a step of half the run is one
  // that the tolerances allow, over which the exits are no polynomials of degree 8. It slips where the drive is 1.
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    Builder b("exit");
    const SX v = b.state("v", {0.0});
    const SX t = b.time();
    b.dynamics("v", 0.5 * t + 0.3 * sin(t) - b.sign(v));
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-8, 1e-10};
    options.until = 5.0;
    const auto result = testing::run_model(b, options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    double exit = 1.5;
    for (int k = 0; k < 20; ++k) exit -= (0.5 * exit + 0.3 * std::sin(exit) - 1.0) / (0.5 + 0.3 * std::cos(exit));
    EXPECT_NEAR(result.events[1].t, exit, 4e-15);  // four roundings of t; the state stands still whatever the step
    EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
    // 293 to 312; a cut adds eighteen places with the fields of both sides.
    EXPECT_LT(result.statistics.rhs_evaluations, 330);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
