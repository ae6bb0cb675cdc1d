// Regions by indicator that meet where their indicators depend on each other: quadrants and more, in closed form.
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Regions;
using result::Termination;
using testing::run_tightly;

/// In the quadrants ++, -+, +-, --.
using Rates = std::array<std::map<std::string, SX>, 4>;

/// Quadrants by indicators -+x -+y, which depend on each other, scaled and in another order.
void by_indicators(Builder& b, const SX& x, const SX& y, const Rates& rates,
                   const std::array<int, 4>& order = {0, 1, 2, 3}, double scale = 1.0) {
  const std::array<const char*, 4> names{"pp", "mp", "pm", "mm"};
  for (const int i : order) {
    const double sx = (i & 1) != 0 ? -1.0 : 1.0, sy = (i & 2) != 0 ? -1.0 : 1.0;
    b.region(-scale * (sx * x + sy * y), rates.at(static_cast<std::size_t>(i)), names.at(static_cast<std::size_t>(i)));
  }
}

/// The same by two switching functions.
void by_steps(Builder& b, const SX& x, const SX& y, const Rates& rates) {
  const SX right = b.step(x, "right"), upper = b.step(y, "upper");
  std::map<std::string, SX> sums;
  for (std::size_t i = 0; i < 4; ++i) {
    const SX weight = ((i & 1U) != 0 ? 1.0 - right : right) * ((i & 2U) != 0 ? 1.0 - upper : upper);
    for (const auto& [state, rate] : rates[i]) {
      sums[state] = sums.contains(state) ? sums[state] + weight * rate : weight * rate;
    }
  }
  for (const auto& [state, rate] : sums) b.dynamics(state, rate);
}

TEST(TiedRegions, QuadrantsHoldTheSolutionAtTheirCornerAndLetItGoAlongAnEdge) {
  // All fields point to the corner: (1/2, 1) is at the edge y = 0 ... x moves at -1, y at -2: edge at t = 1/2, x = 0
  // there, too. From (1, 1): y = 0 at t = 1/2, then along the edge, x = 1 - t, into the corner at t = 1. A wind along
  // x, b = max(t - 2, 0), drives it out at b = 1, t = 3, along the edge of pp and pm: x = (t - 3)^2 / 2.
  Builder b("corner");
  const SX x = b.state("x", {1.0});
  const SX y = b.state("y", {1.0});
  const SX wind = b.max(b.time() - 2.0, 0.0);
  Rates rates;
  for (std::size_t i = 0; i < 4; ++i) {
    const double sx = (i & 1U) != 0 ? -1.0 : 1.0, sy = (i & 2U) != 0 ? -1.0 : 1.0;
    rates[i] = {{"x", -sx + wind}, {"y", SX(-2.0 * sy)}};
  }
  by_indicators(b, x, y, rates);
  const auto run = run_tightly(b, 4.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 3U);
  const std::array<double, 3> times{0.5, 1.0, 3.0};
  const std::array<EventKind, 3> kinds{EventKind::enter_sliding, EventKind::enter_sliding, EventKind::leave_sliding};
  const std::array<Regions, 3> after{Regions{{"pp", "pm"}}, {{"pp", "mp", "pm", "mm"}}, {{"pp", "pm"}}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(run.events[i].t, times[i], 1e-11) << i;
    EXPECT_EQ(run.events[i].kind, kinds[i]) << i;
    EXPECT_EQ(*run.events[i].regions_after, after[i]) << i;
    EXPECT_EQ(run.events[i].unique, true) << i << run.events[i].reason;
  }
  EXPECT_NEAR(run.final.x[0], 0.5, 1e-10);
  EXPECT_NEAR(run.final.x[1], 0.0, 1e-13);
}

/// Fields that point to the corner or turn around it, with a wind that changes, and a third state that hangs on the
/// weights.
Integration random_quadrants(unsigned seed, bool indicators, const std::array<int, 4>& order = {0, 1, 2, 3},
                             double scale = 1.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double pull = 1.0 + unit(random), turn = 1.5 * unit(random);
  const double x0 = unit(random), y0 = unit(random), w = unit(random);
  Builder b("random quadrants");
  const SX x = b.state("x", {x0});
  const SX y = b.state("y", {y0});
  const SX z = b.state("z", {0.0});
  const SX t = b.time();
  Rates rates;
  for (std::size_t i = 0; i < 4; ++i) {
    const double sx = (i & 1U) != 0 ? -1.0 : 1.0, sy = (i & 2U) != 0 ? -1.0 : 1.0;
    const double cx = unit(random), cy = unit(random), cz = unit(random), ct = unit(random);
    rates[i] = {{"x", -pull * sx - turn * sy + 0.5 * cx + 0.5 * ct * sin(2 * t)},
                {"y", -pull * sy + turn * sx + 0.5 * cy + 0.3 * w * t},
                {"z", cz - 0.1 * z}};
  }
  if (indicators) by_indicators(b, x, y, rates, order, scale);
  if (!indicators) by_steps(b, x, y, rates);
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = {1e-11, 1e-13};
  options.until = 6.0;
  return testing::run_model(b, options);
}

void expect_same(const Integration& run, const Integration& reference, double tolerance, unsigned seed) {
  ASSERT_EQ(run.status.termination, Termination::completed) << seed << ": " << run.status.message;
  for (std::size_t k = 0; k < run.final.x.size(); ++k) {
    EXPECT_NEAR(run.final.x[k], reference.final.x[k], tolerance) << seed << ", state " << k;
  }
}

// Both runs are accurate to about 1e-10 (tolerances 1e-11, and what a change of a selection by that moves in 6 units of
// time); other weights at the corner, or another way out of it, would be seen in z or in x and y as 1e-3 and more.
constexpr double same = 1e-8;

TEST(TiedRegions, AreTheSameModelAsTwoSwitchingFunctions) {
  std::size_t held = 0, left = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto steps = random_quadrants(seed, false);
    if (steps.status.termination != Termination::completed) continue;
    const auto regions = random_quadrants(seed, true);
    expect_same(regions, steps, same, seed);
    for (const auto& e : regions.events) {
      if (e.regions_after && e.regions_after->front().size() == 4) ++held;
      if (e.regions_before && e.regions_before->front().size() == 4 && e.kind == EventKind::leave_sliding) ++left;
    }
  }
  EXPECT_GE(held, 150U);
  EXPECT_GE(left, 40U);
}

// Here weights at the corner lose their stability while they are held, and the solution spirals out, in any phase.
TEST(TiedRegions, WeightsThatLoseTheirStabilityAreLeft) {
  const auto steps = random_quadrants(1673, false);
  ASSERT_EQ(steps.families.size(), 1U);
  for (const auto& order : {std::array{0, 1, 2, 3}, std::array{3, 1, 0, 2}}) {
    const auto regions = random_quadrants(1673, true, order);
    ASSERT_EQ(regions.status.termination, Termination::completed) << regions.status.message;
    ASSERT_EQ(regions.families.size(), 1U);
    const auto& spiral = regions.families[0];
    EXPECT_EQ(spiral.kind, result::FamilyKind::spiral);
    EXPECT_NEAR(spiral.from, steps.families[0].from, same);
    EXPECT_NEAR(*spiral.lap_ratio, *steps.families[0].lap_ratio, 1e-6);
    const auto& exit = regions.events[spiral.event];
    EXPECT_EQ(exit.kind, EventKind::leave_sliding);
    EXPECT_EQ(exit.unique, false);
    EXPECT_EQ(exit.regions_before->front().size(), 4U);
    EXPECT_EQ(exit.regions_after->front().size(), 1U);
    // A cycle is four borders further on; from the exit on times grow as cycles do.
    const double first = regions.events[spiral.event + 4].t - exit.t;
    const double second = regions.events[spiral.event + 8].t - exit.t;
    EXPECT_NEAR(second / first, *spiral.lap_ratio, 1e-3 * *spiral.lap_ratio);
  }
}

TEST(TiedRegions, NeitherOrderNorScaleOfTheIndicatorsMatters) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto reference = random_quadrants(seed, true);
    expect_same(random_quadrants(seed, true, {3, 1, 0, 2}), reference, same, seed);
    expect_same(random_quadrants(seed, true, {2, 3, 1, 0}, 1e6), reference, same, seed);
    expect_same(random_quadrants(seed, true, {1, 0, 3, 2}, 1e-7), reference, same, seed);
  }
}

/// Fields (-a sx - b sy, -a sy + b sx) from (1, 0.5 or 0); z' as given.
Integration turning(double a, double b, double y0, std::array<double, 4> z, double until) {
  Builder builder("turning");
  const SX x = builder.state("x", {1.0});
  const SX y = builder.state("y", {y0});
  builder.state("z", {0.0});
  Rates rates;
  for (std::size_t i = 0; i < 4; ++i) {
    const double sx = (i & 1U) != 0 ? -1.0 : 1.0, sy = (i & 2U) != 0 ? -1.0 : 1.0;
    rates[i] = {{"x", SX(-a * sx - b * sy)}, {"y", SX(-a * sy + b * sx)}, {"z", SX(z.at(i))}};
  }
  by_indicators(builder, x, y, rates);
  return run_tightly(builder, until);
}

TEST(TiedRegions, ASpiralEndsAtTheCornerAndRestsThere) {
  // A quarter turn from the distance d takes d / (a + b) = d / 4 and ends at d (b - a) / (a + b) = d / 2: the limit is
  // at t = 1/2. There all weights are 1/4.
  const auto run = turning(1.0, 3.0, 0.0, {1.0, 0.0, 0.0, 0.0}, 2.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  const auto& limit = run.events.back();
  EXPECT_NEAR(limit.t, 0.5, 1e-11);
  EXPECT_EQ(*limit.regions_after, (Regions{{"pp", "mp", "pm", "mm"}}));
  for (const double theta : run.final.theta) EXPECT_NEAR(theta, 0.25, 1e-12);
  // z' = 1 in pp only: 1/4 of the cycles' quarters from 0, 4, 8, ..., 1/4 (1 + 1/16 + ...) = 4/15, then a quarter.
  EXPECT_NEAR(run.final.x[2], 4.0 / 15.0 + 0.25 * 1.5, 1e-10);
}

TEST(TiedRegions, WeightsThatStewartsSystemLeavesOpenAreToldWhereTheyMoveTheState) {
  // (1, -1, -1, 1) are the weights that the corner leaves open.
  const auto open = turning(1.0, 0.0, 0.5, {1.0, 0.0, 0.0, 1.0}, 2.0);
  ASSERT_EQ(open.status.termination, Termination::completed) << open.status.message;
  EXPECT_EQ(open.events.back().unique, false);
  EXPECT_NE(open.events.back().reason.find("soft minima"), std::string::npos);
  const auto closed = turning(1.0, 0.0, 0.5, {2.0, 1.0, 1.0, 0.0}, 2.0);
  ASSERT_EQ(closed.status.termination, Termination::completed) << closed.status.message;
  EXPECT_EQ(closed.events.back().unique, true);
  // Edge at t = 1/2 (half of pp and pm, 3/2), corner at t = 1: the mean of all there.
  EXPECT_NEAR(closed.final.x[2], 1.0 + 0.75 + 1.0, 1e-10);
}

TEST(TiedRegions, ACornerIsCrossed) {
  Builder b("crossing");
  const SX x = b.state("x", {1.0});
  const SX y = b.state("y", {2.0});
  Rates rates;
  rates[0] = {{"x", SX(-1.0)}, {"y", SX(-2.0)}};
  rates[1] = {{"x", SX(-2.0)}, {"y", SX(-1.0)}};
  rates[2] = {{"x", SX(-1.0)}, {"y", SX(-1.0)}};
  rates[3] = {{"x", SX(-3.0)}, {"y", SX(-1.0)}};
  by_indicators(b, x, y, rates);
  const auto run = run_tightly(b, 2.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_NEAR(run.events[0].t, 1.0, 1e-14);
  EXPECT_EQ(run.events[0].kind, EventKind::crossing);
  EXPECT_EQ(*run.events[0].regions_after, (Regions{{"mm"}}));
  EXPECT_EQ(run.events[0].unique, true);
  EXPECT_NEAR(run.final.x[0], -3.0, 1e-12);
}

TEST(TiedRegions, ACornerThatMovesTakesTheSolutionAlong) {
  // The corner is at (t/2, -t/4); fields pull with speed 1 in both directions. In the frame of the corner they are
  // -sx - 1/2 and -sy + 1/4: from (1, 1) y is there at 4/3, at 3/2 - 1/2 * ... x at 2/3 (from the right, speed 3/2).
  Builder b("moving");
  const SX x = b.state("x", {1.0});
  const SX y = b.state("y", {1.0});
  const SX t = b.time();
  Rates rates;
  for (std::size_t i = 0; i < 4; ++i) {
    const double sx = (i & 1U) != 0 ? -1.0 : 1.0, sy = (i & 2U) != 0 ? -1.0 : 1.0;
    rates[i] = {{"x", SX(-sx)}, {"y", SX(-sy)}};
  }
  by_indicators(b, x - 0.5 * t, y + 0.25 * t, rates);
  const auto run = run_tightly(b, 4.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 2U);
  EXPECT_NEAR(run.events[0].t, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(run.events[1].t, 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(run.final.x[0], 2.0, 1e-12);
  EXPECT_NEAR(run.final.x[1], -1.0, 1e-12);
  // Selections (1 - 1/2)/2 of the left and (1 + 1/4)/2 ... of the lower one: products.
  const std::array<double, 4> theta{0.25 * 0.625, 0.75 * 0.625, 0.25 * 0.375, 0.75 * 0.375};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.final.theta[i], theta.at(i), 1e-12) << i;
}

TEST(TiedRegions, FiveSectorsHoldTheSolutionUntilTheWindIsTooStrong) {
  // Fields -c_i to the origin, a wind b along -x from t = 4 on: sum theta_i c_i = (-b, 0) has weights until b =
  // cos 36, the far side of the pentagon, where the three other regions leave together; then along that border.
  Builder builder("sectors");
  const SX x = builder.state("x", {1.0});
  const SX y = builder.state("y", {0.3});
  const SX wind = builder.max(builder.time() - 4.0, 0.0) / 4.0;
  builder.dynamics("x", -wind);
  for (std::size_t i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi / 5.0 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    builder.region(-(c * x + s * y), {{"x", SX(-c)}, {"y", SX(-s)}}, std::string(1, static_cast<char>('a' + i)));
  }
  const auto run = run_tightly(builder, 8.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 3U);
  EXPECT_EQ(*run.events[1].regions_after, (Regions{{"a", "b", "c", "d", "e"}}));
  const double out = std::cos(std::numbers::pi / 5.0);
  EXPECT_NEAR(run.events[2].t, 4.0 + 4.0 * out, 1e-10);
  EXPECT_EQ(*run.events[2].regions_after, (Regions{{"c", "d"}}));
  EXPECT_EQ(run.events[2].kind, EventKind::leave_sliding);
  EXPECT_EQ(run.events[2].unique, true);
  const double time = 4.0 - 4.0 * out;
  EXPECT_NEAR(run.final.x[0], -time * time / 8.0, 1e-10);
  EXPECT_NEAR(run.final.x[1], 0.0, 1e-12);
}

TEST(TiedRegions, ARegionThatIsThereOnTheBorderOnlyHasItsPartOfIt) {
  // min(x, 0, -x): `middle` is nowhere but at x = 0. theta ~ (exp(-v), 1, exp(v)), and x' = 0 asks for equal outer
  // ones.
  Builder b("middle");
  const SX x = b.state("x", {1.0});
  b.state("z", {0.0});
  b.region(x, {{"x", SX(1.0)}}, "left");
  b.region(0.0 * x, {{"z", SX(1.0)}}, "middle");
  b.region(-x, {{"x", SX(-1.0)}}, "right");
  const auto run = run_tightly(b, 4.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  EXPECT_EQ(run.final.regions, (Regions{{"left", "middle", "right"}}));
  EXPECT_EQ(run.events.back().unique, false);
  for (const double theta : run.final.theta) EXPECT_NEAR(theta, 1.0 / 3.0, 1e-13);
  EXPECT_NEAR(run.final.x[1], 1.0, 1e-12);
}

/// Eight octants that pull, with a wind, or three switching functions.
Integration octants(unsigned seed, bool indicators) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Builder b("octants");
  const std::array<SX, 3> x{b.state("x", {unit(random)}), b.state("y", {unit(random)}), b.state("z", {unit(random)})};
  b.state("w", {0.0});
  const std::array<std::string, 3> names{"x", "y", "z"};
  std::array<SX, 3> steps;
  for (std::size_t k = 0; k < 3 && !indicators; ++k) steps.at(k) = b.step(x.at(k), "s" + names.at(k));
  std::map<std::string, SX> sums{{"x", 0}, {"y", 0}, {"z", 0}, {"w", 0}};
  for (unsigned i = 0; i < 8; ++i) {
    SX indicator = 0.0, weight = 1.0;
    std::map<std::string, SX> rates{{"w", unit(random)}};
    for (std::size_t k = 0; k < 3; ++k) {
      const double sign = (i >> k & 1U) != 0 ? -1.0 : 1.0;
      indicator -= sign * x.at(k);
      if (!indicators) weight *= sign > 0.0 ? steps.at(k) : 1.0 - steps.at(k);
      rates[names.at(k)] = -sign + 0.4 * unit(random) + 0.6 * unit(random) * b.time();
    }
    if (indicators) b.region(indicator, rates);
    for (const auto& [state, rate] : rates) sums[state] += weight * rate;
  }
  for (const auto& [state, sum] : sums) {
    if (!indicators) b.dynamics(state, sum);
  }
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = {1e-11, 1e-13};
  options.until = 5.0;
  return testing::run_model(b, options);
}

TEST(TiedRegions, OctantsAreTheSameModelAsThreeSwitchingFunctions) {
  std::size_t held = 0, left = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto steps = octants(seed, false);
    if (steps.status.termination != Termination::completed) continue;
    const auto regions = octants(seed, true);
    expect_same(regions, steps, same, seed);
    for (const auto& e : regions.events) {
      if (e.regions_after && e.regions_after->front().size() == 8) ++held;
      if (e.regions_before && e.regions_before->front().size() == 8) ++left;
    }
  }
  EXPECT_GE(held, 20U);
  EXPECT_GE(left, 5U);
}

}  // namespace
}  // namespace saltus::event_integrator
