#include "saltus/pipeline/surfaces.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/vector_field.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;

/// Surfaces of a system whose states x, y, z rotate slowly; `rate` adds what makes them: a sum of nonsmooth terms.
template <class Rate>
std::vector<result::Surface> surfaces_of(Rate rate) {
  model::Builder model("surfaces");
  const SX x = model.state("x", {2.0}), y = model.state("y", {0.0}), z = model.state("z", {1.0});
  model.dynamics("x", -y);
  model.dynamics("y", x);
  model.dynamics("z", 1e-3 * rate(model, x, y, z));
  const auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  SimulateOptions options;
  options.until = 7.0;
  const auto result = simulate(*system, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : to_text(result.error()));
  return surfaces(*system, *result);
}

TEST(Surfaces, AffineOnesAreTheirCoefficients) {
  const auto found = surfaces_of([](model::Builder& model, const SX& x, const SX& y, const SX& z) {
    const SX k = model.parameter("k", 3.0);
    const SX level = model.sign(y - 0.25, "level");
    return level + model.sign(2 * x - k * z + model.time() - 1, "moving");
  });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "level");
  EXPECT_EQ(found[0].role, result::SurfaceRole::switching);
  EXPECT_EQ(found[0].states, (std::vector<std::string>{"y"}));
  EXPECT_FALSE(found[0].depends_on_time);
  ASSERT_TRUE(found[0].affine.has_value());
  EXPECT_EQ(found[0].affine->gradient, (std::vector<double>{1.0}));
  EXPECT_EQ(found[0].affine->constant, -0.25);
  EXPECT_EQ(found[1].states, (std::vector<std::string>{"x", "z"}));
  EXPECT_TRUE(found[1].depends_on_time);
  ASSERT_TRUE(found[1].affine.has_value());
  EXPECT_EQ(found[1].affine->gradient, (std::vector<double>{2.0, -3.0}));
  EXPECT_EQ(found[1].affine->rate, 1.0);
  EXPECT_EQ(found[1].affine->constant, -1.0);
  EXPECT_TRUE(found[1].curves.empty());
}

TEST(Surfaces, CurvedOnesOfOneOrTwoStatesAreCurvesWithinTheRangeOfTheTrajectory) {
  const auto found = surfaces_of([](model::Builder& model, const SX& x, const SX& y, const SX&) {
    const SX circle = model.sign(x * x + y * y - 1, "circle");
    return circle + model.sign(x * x - 2, "pair");
  });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_FALSE(found[0].affine.has_value());
  ASSERT_EQ(found[0].curves.size(), 1U);
  const auto& circle = found[0].curves[0].coordinates;
  ASSERT_EQ(circle.size(), 2U);
  for (std::size_t i = 0; i < circle[0].size(); ++i) EXPECT_NEAR(std::hypot(circle[0][i], circle[1][i]), 1.0, 1e-3);
  ASSERT_EQ(found[1].curves.size(), 2U);
  EXPECT_NEAR(found[1].curves[0].coordinates[0][0], -std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(found[1].curves[1].coordinates[0][0], std::sqrt(2.0), 1e-12);
}

TEST(Surfaces, OfMoreStatesAreNamedWithoutCurves) {
  const auto found = surfaces_of(
      [](model::Builder& model, const SX& x, const SX& y, const SX& z) { return model.sign(x * y * z - 5, "three"); });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].states, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_FALSE(found[0].affine.has_value());
  EXPECT_TRUE(found[0].curves.empty());
}

TEST(Surfaces, CurvesThatMoveAreRecordedAtSeveralTimes) {
  // A circle that grows from radius 1 to sqrt(1 + 7/5): within the orbit of radius 2.
  const auto found = surfaces_of([](model::Builder& model, const SX& x, const SX& y, const SX&) {
    return model.sign(x * x + y * y - 1 - model.time() / 5, "growing");
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].depends_on_time);
  ASSERT_EQ(found[0].curves.size(), static_cast<std::size_t>(times_of_moving_surface));
  EXPECT_EQ(found[0].curves.front().t, 0.0);
  EXPECT_EQ(found[0].curves.back().t, 7.0);
  for (const auto& curve : found[0].curves) {
    const auto& x = curve.coordinates[0];
    const auto& y = curve.coordinates[1];
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(std::hypot(x[i], y[i]), std::sqrt(1.0 + *curve.t / 5.0), 2e-3);
    }
  }
}

TEST(Surfaces, GuardsOfJumpsAreSurfacesButTimesAreNone) {
  model::System system;
  system.t = SX::sym("t");
  system.x = SX::sym("x", 2);
  system.u = system.p = system.alpha = SX(0, 1);
  system.input = SX(0, 1);
  system.state_names = {"y", "v"};
  model::Jump jump;
  jump.name = "bounce";
  jump.guards = SX::vertcat({-2 * system.x(0) + 1, system.t - 3});
  system.jumps = {jump};
  result::Result result;
  result.states = system.state_names;
  result.final.x = {0.0, 1.0};
  const auto found = surfaces(system, result);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "bounce");
  EXPECT_EQ(found[0].role, result::SurfaceRole::jump);
  EXPECT_EQ(found[0].states, (std::vector<std::string>{"y"}));
  EXPECT_EQ(found[0].affine->gradient, (std::vector<double>{-2.0}));
  EXPECT_EQ(found[0].affine->constant, 1.0);
}

TEST(Surfaces, NestedOnesFollowTheirInnerSwitches) {
  // y = |x| - 1: the tent with its tip at (0, -1).
  const auto found = surfaces_of([](model::Builder& model, const SX& x, const SX& y, const SX&) {
    return model.sign(model.abs(x) - y - 1, "tent");
  });
  const auto tent = std::find_if(found.begin(), found.end(), [](const auto& one) { return one.name == "tent"; });
  ASSERT_NE(tent, found.end());
  EXPECT_EQ(tent->states, (std::vector<std::string>{"x", "y"}));
  ASSERT_EQ(tent->curves.size(), 1U);
  const auto& points = tent->curves[0].coordinates;
  double lowest = 1.0;
  for (std::size_t i = 0; i < points[0].size(); ++i) {
    EXPECT_NEAR(points[1][i], std::abs(points[0][i]) - 1.0, 2e-3);
    lowest = std::min(lowest, points[1][i]);
  }
  EXPECT_NEAR(lowest, -1.0, 2e-3);
}

TEST(Surfaces, TablesAreLookedUpAtEveryPointOfACurve) {
  const auto found = surfaces_of([](model::Builder& model, const SX& x, const SX& y, const SX&) {
    const auto road = model.table("road", {-2, 0, 1, 2}, {0, 1, -1, 0});
    const SX surface = model.sign(y - road(x), "road surface");
    return surface + model.sign(y - model.mod(model.time(), 2), "ramp");
  });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].states, (std::vector<std::string>{"x", "y"}));
  EXPECT_FALSE(found[0].affine.has_value());
  EXPECT_FALSE(found[0].depends_on_time);
  ASSERT_FALSE(found[0].curves.empty());
  const auto exact = [](double x) {
    if (x < -2.0 || x > 2.0) return 0.0;
    return x < 0.0 ? 1.0 + 0.5 * x : x < 1.0 ? 1.0 - 2.0 * x : x - 2.0;
  };
  for (const auto& curve : found[0].curves) {
    ASSERT_EQ(curve.coordinates.size(), 2U);
    for (std::size_t i = 0; i < curve.coordinates[0].size(); ++i) {
      EXPECT_NEAR(curve.coordinates[1][i], exact(curve.coordinates[0][i]), 0.02);
    }
  }
  // A surface that moves, and jumps back: where it is at the time of each curve.
  EXPECT_TRUE(found[1].depends_on_time);
  EXPECT_FALSE(found[1].affine.has_value());
  for (const auto& curve : found[1].curves) {
    ASSERT_TRUE(curve.t.has_value());
    EXPECT_NEAR(curve.coordinates[0][0], *curve.t - 2.0 * std::floor(*curve.t / 2.0), 1e-9);
  }
}

/// Borders of regions around (-1, 0), (1, 0) and (0, 2): they meet in the centre of the circle around these, (0, 3/4).
/// `bend` is added to every indicator: it changes nothing but the form of the functions.
template <class Bend>
std::vector<result::Surface> borders(Bend bend) {
  model::Builder model("regions");
  const SX x = model.state("x", {-0.5}), y = model.state("y", {-0.75});
  int number = 0;
  for (const auto& [a, b] : {std::pair{-1.0, 0.0}, std::pair{1.0, 0.0}, std::pair{0.0, 2.0}}) {
    const SX to_x = a - x, to_y = b - y;
    model.region(bend(x, y) * (to_x * to_x + to_y * to_y), {{"x", 0.2 + 0.01 * number}, {"y", 0.4}},
                 "r" + std::to_string(number));
    ++number;
  }
  model.dynamics("x", 0.0);
  model.dynamics("y", 0.0);
  const auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  SimulateOptions options;
  options.until = 4.0;
  options.native = Native::off;
  const auto result = simulate(*system, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : to_text(result.error()));
  return surfaces(*system, *result);
}

TEST(Surfaces, BordersOfRegionsEndWhereThreeMeet) {
  const auto found = borders([](const SX&, const SX&) { return SX(1.0); });
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name, "r0 | r1");
  EXPECT_EQ(found[0].role, result::SurfaceRole::region);
  ASSERT_TRUE(found[0].affine.has_value());
  // g_1 - g_0 = -4 x where g_2 - g_0 = 3 - 2 x - 4 y >= 0.
  EXPECT_EQ(found[0].affine->gradient, (std::vector<double>{-4.0, 0.0}));
  EXPECT_EQ(found[0].affine->constant, 0.0);
  ASSERT_EQ(found[0].within.size(), 1U);
  EXPECT_EQ(found[0].within[0].gradient, (std::vector<double>{-2.0, -4.0}));
  EXPECT_EQ(found[0].within[0].constant, 3.0);
}

TEST(Surfaces, CurvedBordersOfRegionsAreCutAtTheTriplePoint) {
  const auto found = borders([](const SX& x, const SX&) { return exp(x / 8.0); });
  ASSERT_EQ(found.size(), 3U);
  for (const auto& border : found) {
    EXPECT_FALSE(border.affine.has_value());
    EXPECT_TRUE(border.within.empty());
    ASSERT_EQ(border.curves.size(), 1U) << border.name;
    const auto& points = border.curves[0].coordinates;
    double nearest = 1.0;
    for (std::size_t i = 0; i < points[0].size(); ++i) {
      const double x = points[0][i], y = points[1][i];
      nearest = std::min(nearest, std::hypot(x, y - 0.75));
      if (border.name == "r0 | r1") {
        EXPECT_NEAR(x, 0.0, 1e-3);
        EXPECT_LT(y, 0.75 + 1e-3);
      } else {
        EXPECT_NEAR(3.0 + 2.0 * std::abs(x) - 4.0 * y, 0.0, 1e-2);
        EXPECT_TRUE(border.name == "r0 | r2" ? x < 1e-3 : x > -1e-3) << x;
      }
    }
    EXPECT_LT(nearest, 1e-3) << border.name;
  }
}

TEST(VectorField, ArrowsAreTheFieldsOfBothSidesAndTheSlidingOne) {
  // x' = 1, y' = -3 sign(y) + x: slides on y = 0 while |x| < 3, with the field (1, 0).
  model::Builder model("field");
  const SX x = model.state("x", {-4.0}), y = model.state("y", {1.0});
  model.dynamics("x", 1);
  model.dynamics("y", -3 * model.sign(y) + x);
  const auto system = model.build();
  ASSERT_TRUE(system.has_value());
  SimulateOptions options;
  options.until = 8.0;
  auto result = simulate(*system, options);
  ASSERT_TRUE(result.has_value());
  add_drawings(*system, *result);
  ASSERT_TRUE(result->vector_field.has_value());
  const auto& field = *result->vector_field;
  ASSERT_EQ(field.free.x.size(), 400U);
  for (std::size_t i = 0; i < field.free.x.size(); ++i) {
    EXPECT_EQ(field.free.dx[i], 1.0);
    EXPECT_EQ(field.free.dy[i], (field.free.y[i] > 0.0 ? -3.0 : 3.0) + field.free.x[i]);
  }
  EXPECT_GT(field.sides.x.size(), 20U);
  for (std::size_t i = 0; i < field.sides.x.size(); ++i) {
    EXPECT_NEAR(field.sides.dy[i], (field.sides.y[i] > 0.0 ? -3.0 : 3.0) + field.sides.x[i], 1e-12);
  }
  EXPECT_GT(field.sliding.x.size(), 3U);
  for (std::size_t i = 0; i < field.sliding.x.size(); ++i) {
    EXPECT_EQ(field.sliding.y[i], 0.0);
    EXPECT_LT(std::abs(field.sliding.x[i]), 3.0);
    EXPECT_NEAR(field.sliding.dy[i], 0.0, 1e-12);
  }
}

TEST(VectorField, ModelsWithoutAPlaneHaveNone) {
  model::Builder model("line");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", -model.sign(x));
  const auto system = model.build();
  ASSERT_TRUE(system.has_value());
  SimulateOptions options;
  options.until = 2.0;
  const auto result = simulate(*system, options);
  ASSERT_TRUE(result.has_value());
  EXPECT_FALSE(vector_field(*system, *result).has_value());
}

}  // namespace
}  // namespace saltus::pipeline
