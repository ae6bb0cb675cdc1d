// Roots of what is zero on a surface: crossings in closed form, the rest behind infinitely many of them, exits.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/fesd_integrator/element/time_warp.hpp"
#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;

struct Scheme {
  TableauFamily family = TableauFamily::radau_iia;
  int stages = 2;
  Form form = Form::step;
};

Expected<Integration> try_run(const model::System& system, double until, long steps, const Scheme& scheme,
                              bool sensitivities = false) {
  const auto dcs = reformulation::reformulate(system, {scheme.form, std::nullopt});
  EXPECT_TRUE(dcs.has_value());
  IntegrationOptions options;
  options.tableau = *discretization::butcher_tableau(scheme.family, scheme.stages);
  options.until = until;
  options.steps = steps;
  options.max_events = 200;
  options.error_limit = 0.03;
  options.sensitivities = sensitivities;
  return integrate(system, *dcs, options);
}

Integration run(const model::System& system, double until, long steps, const Scheme& scheme = {}) {
  auto integration = try_run(system, until, steps, scheme);
  EXPECT_TRUE(integration.has_value());
  EXPECT_EQ(integration->status.termination, result::Termination::completed) << integration->status.message;
  return std::move(*integration);
}

constexpr double k1 = 1.5, k2 = 1.1;
const double shrinking = std::exp(-M_PI * (k1 / 4.0) / std::sqrt(k2 / 2.0 - k1 * k1 / 16.0));

/// x' = -k1 sqrt(|x|) sign x + y, y' = -k2 sign x + growth t, from (0, y).
model::System super_twisting(double y, double growth = 0.0) {
  model::Builder builder("super-twisting");
  const SX x = builder.state("x", {0.0});
  const SX v = builder.state("y", {y});
  builder.dynamics("x", -k1 * sqrt(builder.abs(x)) * builder.sign(x) + v);
  builder.dynamics("y", -k2 * builder.sign(x) + growth * builder.time());
  return *builder.build();
}

class EveryScheme : public testing::TestWithParam<std::tuple<TableauFamily, int, Form>> {
 protected:
  [[nodiscard]] static Scheme scheme() {
    return {std::get<0>(GetParam()), std::get<1>(GetParam()), std::get<2>(GetParam())};
  }
};

/// Crossings of |y| = 1, r, r^2, … at (1 + r)/k2 (1 + r + …), rest at (1 + r)/(k2 (1 - r)).
TEST_P(EveryScheme, ASuperTwistingControllerComesToRest) {
  const auto result = run(super_twisting(1.0), 2.0, 200, scheme());
  ASSERT_GE(result.events.size(), 4u);
  const double first = (1.0 + shrinking) / k2;
  EXPECT_NEAR(result.events[1].t, first, 2e-4);
  EXPECT_NEAR(result.events[2].t, first * (1.0 + shrinking), 1e-3);
  const auto& last = result.events.back();
  EXPECT_EQ(last.kind, result::EventKind::accumulation);
  EXPECT_NEAR(last.t, first / (1.0 - shrinking), 3e-3);
  EXPECT_NEAR(result.final.x[0], 0.0, 1e-12);
  EXPECT_NEAR(result.final.x[1], 0.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Schemes, EveryScheme,
                         testing::Values(std::tuple(TableauFamily::radau_iia, 1, Form::step),
                                         std::tuple(TableauFamily::radau_iia, 2, Form::step),
                                         std::tuple(TableauFamily::radau_iia, 2, Form::stewart),
                                         std::tuple(TableauFamily::radau_iia, 4, Form::stewart),
                                         std::tuple(TableauFamily::gauss_legendre, 1, Form::step),
                                         std::tuple(TableauFamily::gauss_legendre, 3, Form::step),
                                         std::tuple(TableauFamily::lobatto_iiia, 3, Form::step),
                                         std::tuple(TableauFamily::lobatto_iiic, 3, Form::step),
                                         std::tuple(TableauFamily::explicit_rk, 4, Form::step)));

/// The elements next to a crossing follow the root of time; those behind them, whose solution is smooth but for a pole
/// that is as near as they are long, leave order 3/2 with small constants.
TEST(Roots, ManyStagesResolveACrossing) {
  const double first = (1.0 + shrinking) / k2;
  const auto error = [&](long steps, const Scheme& scheme) {
    const auto result = run(super_twisting(1.0), 1.15, steps, scheme);
    EXPECT_EQ(result.events.size(), 2u);
    return std::abs(result.events.back().t - first);
  };
  const Scheme gauss{TableauFamily::gauss_legendre, 4};
  EXPECT_LE(error(20, gauss), 2e-8);
  EXPECT_LE(error(320, gauss), 2e-8);
  const double coarse = error(25, {}), fine = error(1600, {});
  EXPECT_LE(fine, coarse / 64.0);  // the constants depend on where in its element the crossing lies
}

/// Behind the limit y' = -k2 (2 alpha - 1) + growth t = 0 holds x = y = 0 until alpha = 1, at t = k2 / growth; then
/// y = growth (t - t_e)^2 / 2.
TEST(Roots, SecondOrderSlidingEndsWhereItsSelectionDoes) {
  constexpr double growth = 0.4, until = 4.0;
  for (const double y : {0.0, 1.0}) {
    const auto result = run(super_twisting(y, growth), until, 100);
    const auto exit = std::find_if(result.events.begin(), result.events.end(),
                                   [](const auto& event) { return event.kind == result::EventKind::leave_sliding; });
    ASSERT_NE(exit, result.events.end()) << y;
    EXPECT_NEAR(exit->t, k2 / growth, 1e-8);
    EXPECT_NEAR(result.final.x[1], 0.5 * growth * std::pow(until - k2 / growth, 2), 1e-6);
  }
}

/// h' = -2 sqrt(h - 1) above a valve at the level 1: h = 1 + (1 - t)^2 until t = 1, and rests.
TEST(Roots, ATankEmptiesToItsValve) {
  for (const int way : {0, 1, 2}) {
    model::Builder builder("tank");
    const SX h = builder.state("h", {2.0});
    const SX level = builder.parameter("level", 1.0);
    const SX above = h - level;
    builder.dynamics("h", way == 0   ? -2.0 * sqrt(builder.abs(above)) * builder.sign(above)
                          : way == 1 ? -sqrt(4.0 * builder.max(above, 0.0))
                                     : -2.0 * pow(builder.abs(above), 0.5) * builder.sign(above));
    const auto system = builder.build();
    ASSERT_TRUE(system.has_value());
    const auto half = run(*system, 0.5, 10, {TableauFamily::gauss_legendre, 2});
    EXPECT_NEAR(half.final.x[0], 1.25, 1e-6) << way;
    EXPECT_NEAR(run(*system, 2.0, 40).final.x[0], 1.0, 1e-6) << way;
  }
}

TEST(Roots, SensitivitiesAreRefused) {
  const auto refused = try_run(super_twisting(1.0), 1.0, 10, {}, true);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::not_available);
}

TEST(Roots, AreRecognised) {
  const auto exponents = [](auto&& term) {
    model::Builder builder("roots");
    const SX x = builder.state("x", {1.0});
    const SX v = builder.state("v", {0.0});
    builder.dynamics("x", v);
    builder.dynamics("v", term(builder, x, builder.parameter("c", 0.3)));
    return reformulation::reformulate(*builder.build())->root_exponents;
  };
  using model::Builder;
  using List = std::vector<double>;
  EXPECT_EQ(exponents([](Builder& b, SX x, SX) { return sqrt(b.abs(x)) * b.sign(x); }), (List{0.5, 0.5}));
  EXPECT_EQ(exponents([](Builder& b, SX x, SX) { return sqrt(b.abs(x)); }), (List{0.5, 0.5}));
  EXPECT_EQ(exponents([](Builder& b, SX x, SX c) { return pow(b.abs(x), c) * b.sign(x); }), (List{0.3, 0.3}));
  EXPECT_EQ(exponents([](Builder& b, SX x, SX) { return sqrt(3.0 * b.max(x - 2.0, 0.0)); }), (List{0.5}));
  EXPECT_EQ(exponents([](Builder& b, SX x, SX) { return pow(b.abs(x), 1.5) * b.sign(x); }), List{});
  EXPECT_EQ(exponents([](Builder& b, SX x, SX) { return sqrt(b.abs(x) + 1.0) * b.sign(x); }), List{});
}

TEST(TimeWarp, GoesFromOneEndToTheOther) {
  for (const int left : {1, 2, 3, 4}) {
    for (const int right : {1, 2, 3, 4}) {
      const TimeWarp warp{left, right}, mirrored{right, left};
      EXPECT_EQ(warp.at(0.0), 0.0);
      EXPECT_EQ(warp.at(1.0), 1.0);
      for (const double tau : {0.01, 0.2, 0.5, 0.7, 0.99}) {
        constexpr double step = 1e-5;
        const double difference = (warp.at(tau + step) - warp.at(tau - step)) / (2.0 * step);
        EXPECT_NEAR(warp.slope(tau), difference, 1e-8);
        EXPECT_NEAR(warp.inverse(warp.at(tau)), tau, 1e-9);
        EXPECT_NEAR(warp.at(tau) + mirrored.at(1.0 - tau), 1.0, 1e-14);
      }
    }
  }
  EXPECT_EQ((TimeWarp{2, 1}.at(0.25)), 0.0625);
  EXPECT_EQ(warp_for(0.5, 4), 2);
  EXPECT_EQ(warp_for(2.0 / 3.0, 4), 3);
  EXPECT_EQ(warp_for(2.0 / 3.0, 2), 2);
  EXPECT_EQ(warp_for(0.5, 1), 1);
  EXPECT_EQ(warp_for(0.7, 4), 4);
}

}  // namespace
}  // namespace saltus::fesd_integrator
