// The linear part of the motion in a mode: its columns are differences of the field, and modes that are not affine have
// none.
#include "saltus/event_integrator/field/linear_motion.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

evaluation::ModelKernel compiled(const model::System& system) {
  auto kernel = evaluation::ModelKernel::compile(system);
  EXPECT_TRUE(kernel.has_value());
  return std::move(*kernel);
}

std::vector<double> times(const ode::LinearField& field, const std::vector<double>& v) {
  std::vector<double> product;
  for (std::size_t i = 0; i < v.size(); ++i) {
    double sum = field.diagonal[i] * v[i];
    for (std::size_t k = field.start[i]; k < field.start[i + 1]; ++k) sum += field.entry[k] * v[field.column[k]];
    product.push_back(sum);
  }
  return product;
}

struct Regions {
  evaluation::FieldConstants below, above;
};

Regions regions_of(evaluation::ModelKernel& kernel) {
  Regions regions;
  const double zero = 0.0, one = 1.0;
  kernel.prepare_field(&zero, regions.below);
  kernel.prepare_field(&one, regions.above);
  return regions;
}

/// f- + s (f+ - f-) with J f + rate = 0.
std::vector<double> sliding_field(evaluation::ModelKernel& kernel, const Regions& regions,
                                  const std::vector<double>& normal, double rate, double t,
                                  const std::vector<double>& x) {
  std::vector<double> below(x.size()), above(x.size());
  kernel.prepared_field(t, x.data(), regions.below, below.data());
  kernel.prepared_field(t, x.data(), regions.above, above.data());
  double g_below = rate, g_above = rate;
  for (std::size_t i = 0; i < x.size(); ++i) {
    g_below += normal[i] * below[i];
    g_above += normal[i] * above[i];
  }
  const double selection = g_below / (g_below - g_above);
  for (std::size_t i = 0; i < x.size(); ++i) below[i] += selection * (above[i] - below[i]);
  return below;
}

TEST(LinearMotion, OfARegionIsThatOfItsSelections) {
  auto s = testing::blank(2, 1);
  testing::add_surface(s, "x", s.x(0));
  const SX alpha = s.alpha(0);
  testing::set_field(s, {(1 + 2 * alpha) * s.x(1) - 3 * s.x(0) + s.t, 5 - alpha * s.x(1)}, {0, 0});
  auto kernel = compiled(s);
  const auto regions = regions_of(kernel);
  LinearMotion motion;
  const auto* below = motion.of_region(kernel, regions.below);
  ASSERT_NE(below, nullptr);
  EXPECT_EQ(times(*below, {1, 0}), (std::vector<double>{-3, 0}));
  EXPECT_EQ(times(*below, {0, 1}), (std::vector<double>{1, 0}));
  EXPECT_EQ(below->rate, (std::vector<double>{1, 0}));
  motion.forget();
  const auto* above = motion.of_region(kernel, regions.above);
  ASSERT_NE(above, nullptr);
  EXPECT_EQ(times(*above, {0, 1}), (std::vector<double>{3, -1}));
  // The difference of the fields is not constant: sliding between them is not affine.
  motion.forget();
  const std::vector<double> normal{1, 0};
  EXPECT_EQ(motion.on_surface(kernel, regions.below, regions.above, {normal.data(), 0}), nullptr);
}

TEST(LinearMotion, OfNonlinearFieldsThereIsNone) {
  for (const bool squared : {false, true}) {
    auto s = testing::blank(2, 1);
    testing::add_surface(s, "x", s.x(0));
    const SX x = s.x(0);
    testing::set_field(s, {s.x(1) + s.alpha(0), squared ? x * x : sin(s.t)}, {0, 0});
    auto kernel = compiled(s);
    LinearMotion motion;
    EXPECT_EQ(motion.of_region(kernel, regions_of(kernel).below), nullptr);
  }
}

TEST(LinearMotion, OnAnObliqueSurfaceThatMovesItsColumnsAreDifferencesOfTheField) {
  auto s = testing::blank(3, 1);
  const std::vector<double> normal{0.6, -0.3, 1.1};
  const double rate = 0.25;
  testing::add_surface(s, "oblique", 0.6 * s.x(0) - 0.3 * s.x(1) + 1.1 * s.x(2) + rate * s.t);
  const SX alpha = s.alpha(0);
  testing::set_field(s,
                     {-s.x(0) + 2 * s.x(1) - 3 * alpha + 0.5 * s.t, s.x(0) - s.x(2) + alpha,
                      0.7 * s.x(1) - 0.2 * s.x(2) + 1 - 2 * alpha},
                     {0, 0, 0});
  auto kernel = compiled(s);
  const auto regions = regions_of(kernel);
  LinearMotion motion;
  const auto* field = motion.on_surface(kernel, regions.below, regions.above, {normal.data(), -1});
  ASSERT_NE(field, nullptr);
  const auto at_origin = sliding_field(kernel, regions, normal, rate, 0.0, {0, 0, 0});
  for (std::size_t j = 0; j < 3; ++j) {
    std::vector<double> unit(3, 0.0);
    unit[j] = 1.0;
    const auto column = times(*field, unit);
    const auto beside = sliding_field(kernel, regions, normal, rate, 0.0, unit);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(column[i], beside[i] - at_origin[i], 32 * epsilon) << i << j;
  }
  const auto later = sliding_field(kernel, regions, normal, rate, 1.0, {0, 0, 0});
  ASSERT_EQ(field->rate.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(field->rate[i], later[i] - at_origin[i], 32 * epsilon) << i;
  // Once found it is not looked for again.
  EXPECT_EQ(motion.on_surface(kernel, regions.below, regions.above, {normal.data(), -1}), field);
}

TEST(LinearMotion, ACoordinateThatIsHeldHasNoMotionAtAll) {
  const auto s = testing::relay();
  auto kernel = compiled(s);
  const auto regions = regions_of(kernel);
  LinearMotion motion;
  const std::vector<double> normal{1, 0, 0};
  const auto* field = motion.on_surface(kernel, regions.below, regions.above, {normal.data(), 0});
  ASSERT_NE(field, nullptr);
  for (const auto& v : {std::vector<double>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) EXPECT_EQ(times(*field, v)[0], 0.0);
  // x2' = x3 + 2 u, x3' = -u with u = x2 on x1 = 0.
  EXPECT_EQ(times(*field, {0, 1, 0}), (std::vector<double>{0, 2, -1}));
  EXPECT_EQ(times(*field, {0, 0, 1}), (std::vector<double>{0, 1, 0}));
}

TEST(LinearMotion, FieldsWithoutAPushHaveNone) {
  auto s = testing::blank(2, 1);
  testing::add_surface(s, "x", s.x(0));
  testing::set_field(s, {s.x(1), -s.x(0) + s.alpha(0)}, {0, 0});
  auto kernel = compiled(s);
  const auto regions = regions_of(kernel);
  const std::vector<double> normal{1, 0};
  LinearMotion motion;
  EXPECT_EQ(motion.on_surface(kernel, regions.below, regions.above, {normal.data(), 0}), nullptr);
}

/// Evaluations of a run say by which steps it was made: a series needs one of each region.
TEST(LinearMotion, RunsOfAffineModesTakeSeriesThroughSlidingToo) {
  const auto evaluations = [](ode::Method method) {
    const auto system = testing::relay();
    auto kernel = compiled(system);
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-8, 1e-10};
    options.until = 10.0;
    const auto result = integrate(kernel, options);
    EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    EXPECT_NEAR(result.final.x[1], -0.8973301894997, 1e-8);
    EXPECT_NEAR(result.final.x[2], 2.3586988111948, 1e-8);
    return result.statistics.rhs_evaluations;
  };
  EXPECT_LT(5 * evaluations(ode::Method::taylor), evaluations(ode::Method::dop853));
}

}  // namespace
}  // namespace saltus::event_integrator
