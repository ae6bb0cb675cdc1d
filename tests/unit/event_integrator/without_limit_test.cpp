// Right-hand sides that have no limit at the state a solution arrives at.
#include "saltus/event_integrator/decide/sets/without_limit.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using result::Termination;

/// A quasi-continuous controller of order 2 with a disturbance: v' between -2.2 and 2.2, to x = v = 0 at t = 3.085.
Integration run_quasi_continuous(ode::Method method, double added) {
  model::Builder builder("quasi-continuous");
  const SX x = builder.state("x", {1.0}), v = builder.state("v", {0.5});
  const SX root = sqrt(builder.abs(x));
  builder.dynamics("x", v);
  builder.dynamics("v",
                   0.2 * cos(2 * builder.time()) - 2 * (v + root * builder.sign(x)) / (builder.abs(v) + root + added));
  IntegrationOptions options;
  options.method = method;
  options.until = 6.0;
  return testing::run_model(builder, options);
}

TEST(WithoutLimit, AControllerOfHomogeneityDegreeZeroEndsAtItsOriginAndSaysWhy) {
  for (const auto method : {ode::Method::dop853, ode::Method::dopri5, ode::Method::radau5, ode::Method::taylor}) {
    const auto run = run_quasi_continuous(method, 0.0);
    EXPECT_EQ(run.status.termination, Termination::outside_class);
    EXPECT_NE(run.status.message.find("the rate of 'v' has no limit"), std::string::npos) << run.status.message;
    EXPECT_NE(run.status.message.find("-1.8 to 2.2"), std::string::npos) << run.status.message;
    EXPECT_NEAR(run.status.time_reached, 3.08531809, 1e-7);
  }
}

/// The remedy that the message names.
TEST(WithoutLimit, WithANumberAddedToTheDenominatorItStaysThere) {
  for (const double added : {1e-2, 1e-3}) {
    const auto run = run_quasi_continuous(ode::Method::radau5, added);
    ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
    // (v + r)/(|v| + r + added) = cos(2 t)/10 with r = sqrt(x) is balanced by r <= added / 9, so that x is below
    // added^2 / 81, and v of that order: 1.2e-6 and 1.2e-8.
    for (const double value : run.final.x) EXPECT_NEAR(value, 0.0, added * added / 10.0);
  }
}

/// f at the origin itself, without a run.
std::optional<std::string> at_origin(const std::function<SX(model::Builder&, const SX&, const SX&)>& rate) {
  model::Builder builder("at the origin");
  const SX x = builder.state("x", {0.0}), v = builder.state("v", {0.0});
  builder.dynamics("x", v);
  builder.dynamics("v", rate(builder, x, v));
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value());
  auto kernel = evaluation::ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  const SwitchingContext switching_context{*kernel, true, switching::SelectionPolicy::active_dominant, {}};
  return without_limit(switching_context, 0.0, {0.0, 0.0}, std::vector<double>(system->switching.size(), 0.5), 1e-10);
}

TEST(WithoutLimit, RootsKinksAndJumpsOfListedSignsHaveLimits) {
  EXPECT_EQ(at_origin([](auto&, const SX& x, const SX& v) { return 3.0 - x - 2.0 * v; }), std::nullopt);
  EXPECT_EQ(at_origin([](auto& b, const SX& x, const SX& v) { return b.abs(x) - 2.0 * b.abs(v); }), std::nullopt);
  EXPECT_EQ(at_origin([](auto& b, const SX& x, const SX& v) { return -3.0 * b.sign(x) - 2.0 * b.sign(v); }),
            std::nullopt);
  EXPECT_EQ(at_origin([](auto& b, const SX& x, const SX& v) {
              return -pow(b.abs(x), 1.0 / 3.0) * b.sign(x) - sqrt(b.abs(v)) * b.sign(v);
            }),
            std::nullopt);
  EXPECT_NE(at_origin([](auto& b, const SX& x, const SX& v) {
              return x * v / (x * x + v * v) + b.abs(x) + x / (b.abs(x) + b.abs(v));
            }),
            std::nullopt);
}

}  // namespace
}  // namespace saltus::event_integrator
