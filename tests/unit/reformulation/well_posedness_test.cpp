#include "saltus/reformulation/well_posedness.hpp"

#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "dcs_tools.hpp"

namespace saltus::reformulation {
namespace {

using casadi::SX;
using model::Builder;

constexpr ReformulationOptions as_lifted{.reformulation = Form::step, .lifting = 2};

ActiveSetRank rank_of(const model::System& system, const ReformulationOptions& options, const SolutionPoint& point) {
  return WellPosedness(dcs_of(system, options), system).rank_at(point);
}

/// x' = c - sign(n'x) d with |n| = |d| = 1: W B = -2 n'd.
TEST(WellPosedness, OfOneSurfaceIsTheCosineOfItsFieldsJump) {
  for (const double angle : {0.0, 1.0, 1.5707963267948966}) {
    Builder builder("angle");
    const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
    const SX s = builder.sign(x, "c");
    builder.dynamics("x", 0.1 - std::cos(angle) * s);
    builder.dynamics("y", 0.2 - std::sin(angle) * s);
    const auto rank = rank_of(built(builder), as_step, {0.0, {0.0, 1.0}, {}, {0}, {0.5}});
    EXPECT_EQ(rank.unknowns, 1);
    EXPECT_NEAR(rank.smallest_singular_value, std::abs(std::cos(angle)), 1e-15);
    EXPECT_EQ(rank.rank, angle < 1.5 ? 1 : 0) << "fields whose difference is tangent determine no alpha";
  }
}

TEST(WellPosedness, OnlyWhatSlidesIsUnknown) {
  Builder builder("two");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  builder.dynamics("x", -builder.sign(x));
  builder.dynamics("y", -builder.sign(y) * builder.step(x));
  const auto system = built(builder);
  const auto off = rank_of(system, as_step, {0.0, {1.0, -1.0}, {}, {1, -1}, {1.0, 0.0}});
  EXPECT_EQ(off.unknowns, 0);
  EXPECT_TRUE(std::isinf(off.smallest_singular_value));
  const SolutionPoint on_first{0.0, {0.0, -1.0}, {}, {0, -1}, {0.5, 0.0}};
  EXPECT_EQ(rank_of(system, as_step, on_first).surfaces, std::vector<int>{0});
  EXPECT_EQ(rank_of(system, as_step, on_first).rank, 1);
  const auto stewart = rank_of(system, as_stewart, on_first);
  EXPECT_EQ(stewart.regions, 2) << "of four";
  EXPECT_EQ(stewart.unknowns, 3) << "two multipliers and mu";
  EXPECT_EQ(stewart.rank, 3);
}

/// Four fields that all point to the intersection of two surfaces. The equations are psi_1' = 0, psi_2' = 0 and
/// e'theta = 1, for four multipliers in Stewart's form: the fields here differ in a third state, so that there is a set
/// of solutions, all of them Filippov's. The step form chooses theta as products and is determined.
class Intersection : public ::testing::Test {
 protected:
  Intersection() {
    Builder builder("intersection");
    const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
    std::ignore = builder.state("z", {0.0});
    const SX a = builder.step(x, "c1"), b = builder.step(y, "c2");
    builder.dynamics("x", 1 - 2 * a);
    builder.dynamics("y", 1 - 2 * b);
    builder.dynamics("z", 3 * a * b);
    system = built(builder);
    point = {0.0, {0.0, 0.0, 0.0}, {}, {0, 0}, {0.5, 0.5}};
  }
  model::System system;
  SolutionPoint point;
};

TEST_F(Intersection, IsDeterminedInTheStepForm) {
  for (const auto& options : {as_step, as_lifted}) {
    const auto rank = rank_of(system, options, point);
    EXPECT_EQ(rank.unknowns, 2);
    EXPECT_EQ(rank.rank, 2);
  }
  EXPECT_EQ(field(dcs_of(system, as_step), {0, 0, 0}, {0.5, 0.5}), (std::vector<double>{0.0, 0.0, 0.75}));
}

TEST_F(Intersection, HasASetOfSolutionsInStewartsForm) {
  const auto rank = rank_of(system, as_stewart, point);
  EXPECT_EQ(rank.regions, 4);
  EXPECT_EQ(rank.unknowns, 5);
  EXPECT_EQ(rank.rank, 4);
  EXPECT_LT(rank.smallest_singular_value, 1e-15);
  // theta = (s, 1/2 - s, 1/2 - s, s) for (++, +-, -+, --): all of them solve the equations, each with another field.
  const Dcs dcs = dcs_of(system, as_stewart);
  for (const double s : {0.0, 0.125, 0.25, 0.5}) {
    const auto f = field(dcs, {0, 0, 0}, {s, 0.5 - s, 0.5 - s, s});
    EXPECT_EQ(f, (std::vector<double>{0.0, 0.0, 3.0 * s})) << s;
  }
}

TEST(WellPosedness, OfRegionsByIndicator) {
  Builder builder("regions");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  builder.region(x, {{"x", 1}, {"y", 0}});
  builder.region(-x, {{"x", -1}, {"y", 0}});
  builder.region(y + 1, {{"x", 0}, {"y", 1}});
  const auto system = built(builder);
  for (const auto& options : {as_step, as_stewart}) {
    const auto two = rank_of(system, options, {0.0, {0.0, 0.0}, {}, {0, 0, -1}, {0.5, 0.5, 0.0}});
    EXPECT_EQ(two.regions, 2);
    EXPECT_EQ(two.unknowns, 3);
    EXPECT_EQ(two.rank, 3);
    const auto three = rank_of(system, options, {0.0, {0.0, -1.0}, {}, {0, 0, 0}, {0.5, 0.5, 0.0}});
    EXPECT_EQ(three.unknowns, 4);
    EXPECT_EQ(three.rank, 4);
  }
}

}  // namespace
}  // namespace saltus::reformulation
