// The regularised right-hand side against its definition, and its results in the words of the original.
#include "saltus/smoothed/regularise.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/smoothed/restate.hpp"

namespace saltus::smoothed {
namespace {

using casadi::SX;
using model::Builder;
using model::System;

constexpr double epsilon = 0.25;

System built(Builder& builder) {
  auto system = builder.build();
  if (!system) throw std::runtime_error(system.error().message);
  return *std::move(system);
}

/// f of a regularised system at a state, its corner functions decided by their signs, inner ones first.
std::vector<double> field_at(const System& system, const std::vector<double>& x) {
  std::vector<double> alpha(system.switching.size(), 0.0);
  const auto value = [&](const SX& expression) {
    const casadi::Function function("f", {system.x, system.alpha}, {expression});
    return std::vector<double>(function(std::vector<casadi::DM>{x, alpha}).at(0));
  };
  for (std::size_t j = 0; j < alpha.size(); ++j) alpha[j] = value(system.switching[j].psi).front() > 0.0 ? 1.0 : 0.0;
  return value(system.f);
}

double clamped(double psi) { return std::clamp((psi / epsilon + 1.0) / 2.0, 0.0, 1.0); }

TEST(Regularise, IsTheDefinitionInsideAndOutsideOfTheLayer) {
  Builder builder("one");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  builder.dynamics("x", 2 - builder.sign(x - y) * x);
  builder.dynamics("y", builder.abs(y));
  const System original = built(builder);
  const auto regular = regularise(original, epsilon);
  ASSERT_TRUE(regular) << regular.error().message;
  ASSERT_EQ(regular->system.switching.size(), 3u) << "two corners, and the kink that stays";
  for (const auto& function : regular->system.switching) EXPECT_TRUE(function.inner.empty());
  for (const double x0 : {-1.0, -0.26, -0.24, -0.1, 0.0, 0.2, 0.249, 0.26, 3.0}) {
    const double y0 = 0.01;
    const auto f = field_at(regular->system, {x0, y0});
    EXPECT_NEAR(f[0], 2.0 - (2.0 * clamped(x0 - y0) - 1.0) * x0, 1e-14) << x0;
    EXPECT_EQ(f[1], y0);
  }
}

TEST(Regularise, OutsideOfTheLayerTheFieldIsTheOriginalToTheBit) {
  Builder builder("bits");
  const SX x = builder.state("x", {0.0});
  builder.dynamics("x", 0.3 - 0.7 * builder.sign(x) + sin(x));
  const System original = built(builder);
  const auto regular = regularise(original, epsilon);
  ASSERT_TRUE(regular);
  for (const double x0 : {-7.3, -0.3, 0.3, 11.1}) {
    EXPECT_EQ(field_at(regular->system, {x0}), field_at(original, {x0})) << x0;
  }
}

TEST(Regularise, TwoInclusionsDifferInTheLayer) {
  const auto rate = [](model::Inclusion inclusion) {
    Builder builder("product");
    builder.set_inclusion(inclusion);
    const SX x = builder.state("x", {0.0});
    const SX alpha = builder.step(x);
    builder.dynamics("x", (1 + 3 * alpha) * (2 * alpha - 1));
    const auto regular = regularise(built(builder), epsilon);
    return field_at(regular->system, {0.1}).front();
  };
  const double alpha = clamped(0.1);
  EXPECT_NEAR(rate(model::Inclusion::filippov), -1.0 + 5.0 * alpha, 1e-14);
  EXPECT_NEAR(rate(model::Inclusion::aizerman_pyatnitskii), (1 + 3 * alpha) * (2 * alpha - 1), 1e-14);
}

TEST(Regularise, NestedFunctionsHaveALayerOnEachSide) {
  Builder builder("nested");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const SX inner = builder.step(x, "inner");
  const SX outer = builder.step(y - inner, "outer");
  builder.dynamics("x", inner * outer);
  builder.dynamics("y", outer);
  const auto regular = regularise(built(builder), epsilon);
  ASSERT_TRUE(regular);
  EXPECT_EQ(regular->system.switching.size(), 6u);
  // The product is that of one side: outer counts as it is for x > 0.
  for (const double x0 : {-1.0, -0.2, 0.1, 1.0}) {
    for (const double y0 : {-0.1, 0.1, 0.5, 0.9, 1.1, 2.0}) {
      const double a = clamped(x0);
      const auto f = field_at(regular->system, {x0, y0});
      EXPECT_NEAR(f[0], a * clamped(y0 - 1.0), 1e-14) << x0 << ", " << y0;
      EXPECT_NEAR(f[1], a * clamped(y0 - 1.0) + (1.0 - a) * clamped(y0), 1e-14) << x0 << ", " << y0;
    }
  }
}

TEST(Regularise, TooManySurfacesInsideOthersAreRefused) {
  Builder builder("many");
  const SX y = builder.state("y", {0.0});
  for (int i = 0; i < 7; ++i) {
    const std::string name = "x" + std::to_string(i);
    const SX x = builder.state(name, {0.0});
    builder.dynamics(name, builder.step(y - builder.step(x)));
  }
  builder.dynamics("y", 1);
  const auto regular = regularise(built(builder), epsilon);
  ASSERT_FALSE(regular);
  EXPECT_EQ(regular.error().code, ErrorCode::not_available);
  EXPECT_NE(regular.error().message.find("here 7"), std::string::npos) << regular.error().message;
}

/// inner at mode -1, 0, 1 decides which of the outer function's two layers counts.
TEST(Restate, ModesOfNestedFunctionsFollowTheSideTheSolutionIsOn) {
  Builder builder("nested");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const SX inner = builder.step(x, "inner");
  builder.dynamics("x", 1);
  builder.dynamics("y", inner * builder.step(y - inner, "outer"));
  const auto regular = regularise(built(builder), epsilon);
  ASSERT_TRUE(regular);
  ASSERT_EQ(regular->system.columns.size(), 6u);  // inner: lower, upper; outer for inner = 0, then 1
  const auto mode_of = [&](const result::Mode& edges) -> result::Mode {
    result::Trajectory rows{
        .t = {0.0}, .x = {{0, 0}}, .u = {{}}, .alpha = {{}}, .mode = {edges}, .outputs = {{0.5, 0.5}}};
    result::Events none;
    result::Status status;
    restate(*regular, none, rows, status);
    EXPECT_TRUE(rows.outputs.front().empty());
    return rows.mode.front();
  };
  EXPECT_EQ(mode_of({-1, -1, 1, 1, 1, -1}), (result::Mode{-1, 1}));
  EXPECT_EQ(mode_of({1, 1, 1, 1, 1, -1}), (result::Mode{1, 0}));
  EXPECT_EQ(mode_of({1, -1, 1, 1, 1, -1}), (result::Mode{0, 0}));
  EXPECT_EQ(mode_of({1, -1, 1, 1, 1, 1}), (result::Mode{0, 1}));
}

TEST(Restate, EdgesBecomeEventsOfTheSurfaceAndSwappedNamesAreSwapped) {
  Builder builder("alias");
  const SX x = builder.state("x", {0.0});
  builder.switching("up", x);
  builder.switching("down", -x);
  builder.dynamics("x", 2 - builder.sign(x));
  const auto regular = regularise(built(builder), epsilon);
  ASSERT_TRUE(regular);
  ASSERT_EQ(regular->columns.size(), 2u);
  result::Trajectory rows;
  rows.t = {1.0, 1.0};
  rows.x = {{-0.25}, {-0.25}};
  rows.u = {{}, {}};
  rows.alpha = {{0, 0}, {0, 0}};
  rows.mode = {{-1, -1}, {1, -1}};
  rows.outputs = {{0.0, 0.0}, {1e-17, 1e-17}};
  result::Event edge;
  edge.t = 1.0;
  edge.kind = result::EventKind::crossing;
  edge.mode_before = rows.mode[0];
  edge.mode_after = rows.mode[1];
  edge.alpha_before = edge.alpha_after = std::vector<double>{0, 0};
  result::Events events{edge};
  result::Status status;
  restate(*regular, events, rows, status);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, result::EventKind::enter_sliding);
  EXPECT_EQ(events[0].surfaces, (std::vector<std::string>{"up", "down"}));
  EXPECT_EQ(events[0].mode_before, (result::Mode{-1, 1}));
  EXPECT_EQ(events[0].mode_after, (result::Mode{0, 0}));
  EXPECT_EQ(events[0].alpha_before, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(events[0].alpha_after, (std::vector<double>{1e-17, 1.0}));
  EXPECT_EQ(events[0].reason, "enters the layer |up| <= 0.25; enters the layer |down| <= 0.25");
}

}  // namespace
}  // namespace saltus::smoothed
