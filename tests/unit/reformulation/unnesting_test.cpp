// Functions inside others, tables of the state, and what is held: the surfaces they become and the field they give.
#include <cmath>
#include <set>

#include <casadi/core/function.hpp>
#include <gtest/gtest.h>

#include "dcs_tools.hpp"
#include "saltus/model/recognition/condition.hpp"

namespace saltus::reformulation {
namespace {

using casadi::SX;
using model::Builder;

std::vector<std::string> names(const Dcs& dcs) {
  std::vector<std::string> result;
  for (const auto& surface : dcs.surfaces) result.push_back(surface.name);
  return result;
}

/// The step selections at a point off the surfaces.
std::vector<double> selection_at(const Dcs& dcs, const std::vector<double>& x) {
  auto alpha = indicators(dcs, x);
  for (double& one : alpha) one = one > 0.0 ? 1.0 : 0.0;
  return alpha;
}

TEST(Unnesting, MaxOfThreeHasThreeSurfacesAndItsOwnValue) {
  Builder builder("max");
  const SX a = builder.state("a", {0.0}), b = builder.state("b", {0.0}), c = builder.state("c", {0.0});
  builder.dynamics("a", builder.max(builder.max(a, b), c));
  builder.dynamics("b", 1);
  builder.dynamics("c", 1);
  const Dcs dcs = dcs_of(built(builder), as_step);
  EXPECT_EQ(indicators(dcs, {5, 3, 1}), (std::vector<double>{2, 4, 2})) << "a - b; a - c where a > b, else b - c";
  EXPECT_FALSE(SX::depends_on(dcs.indicator, dcs.selection));
  for (const std::vector<double>& x : {std::vector<double>{1, 2, 3}, {3, 1, 2}, {2, 3, 1}, {-1, -3, -2}}) {
    EXPECT_EQ(field(dcs, x, selection_at(dcs, x))[0], std::max({x[0], x[1], x[2]}));
  }
}

/// sign(y - step(x)), where the inner function jumps: alpha of the outer one is a sum over the sides of the inner one.
TEST(Unnesting, AlphaOfANestedFunctionIsTheWeightedSumOfItsSides) {
  Builder builder("nested");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const SX inner = builder.step(x, "inner");
  builder.dynamics("x", 1);
  builder.dynamics("y", inner * builder.step(y - inner, "outer"));
  const Dcs dcs = dcs_of(built(builder), as_step);
  ASSERT_EQ(names(dcs), (std::vector<std::string>{"inner", "outer (inner > 0)", "outer (inner < 0)"}));
  EXPECT_EQ(indicators(dcs, {0.5, 3}), (std::vector<double>{0.5, 2, 3}));
  const auto alpha = uniform(3, 4);
  EXPECT_EQ(value(dcs, dcs.alpha, {0, 0}, alpha),
            (std::vector<double>{alpha[0], alpha[0] * alpha[1] + (1 - alpha[0]) * alpha[2]}));
  // inner * outer is multi-affine: alpha_inner^2 is alpha_inner, so that the other side has no part in it.
  EXPECT_EQ(field(dcs, {0, 0}, alpha)[1], alpha[0] * alpha[1]);
}

TEST(Unnesting, SidesWithoutTheStateAreFoldedOrHeld) {
  Builder builder("sides");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  const SX t = builder.time();
  builder.dynamics("x", builder.step(builder.max(x, 0) + 1, "constant below"));
  builder.dynamics("y", builder.step(builder.if_(model::greater(y, 0), x - 3, t - 2), "time below"));
  const Dcs dcs = dcs_of(built(builder), as_step);
  EXPECT_EQ(names(dcs), (std::vector<std::string>{"x", "constant below (x > 0)", "y", "time below (y > 0)"}));
  ASSERT_EQ(dcs.held_symbols.size(), 1u);
  const casadi::Function argument("argument", {dcs.t}, {dcs.held_symbols[0].argument});
  EXPECT_EQ(static_cast<double>(argument(casadi::DM(5.0)).front()), 3.0);
  // Below x = 0 the first is step(1) = 1.
  const casadi::Function f("f", {dcs.selection, dcs.held}, {dcs.f});
  const auto at_sides = [&](const std::vector<double>& alpha, double held) {
    return std::vector<double>(f(std::vector<casadi::DM>{alpha, held}).front());
  };
  EXPECT_EQ(at_sides({0, 0, 0, 1}, 0.0), (std::vector<double>{1, 0}));
  EXPECT_EQ(at_sides({1, 0, 0, 0}, 1.0), (std::vector<double>{0, 1}));
  EXPECT_EQ(at_sides({1, 0, 1, 0}, 1.0), (std::vector<double>{0, 0}));
}

/// The sides of different functions may vanish together: one surface, with the sides swapped where the factor is
/// negative.
TEST(Unnesting, EqualSidesAreOneSurface) {
  Builder builder("equal");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  builder.dynamics("x", builder.step(2 * (y - 1), "y1"));
  builder.dynamics("y", builder.sign(1 + builder.max(x, 0) - y, "nested"));
  const Dcs dcs = dcs_of(built(builder), as_step);
  EXPECT_EQ(names(dcs), (std::vector<std::string>{"y1", "x", "nested (x > 0)"}));
  // Where x < 0 the nested function is 1 - y: its alpha is 1 - alpha of y - 1.
  EXPECT_EQ(field(dcs, {0, 0}, {0.25, 0, 0.1}), (std::vector<double>{0.25, 0.5}));
}

TEST(Unnesting, TablesOfTheStateAreSumsOfStepsAtTheirBreaks) {
  for (const auto kind : {model::TableKind::linear, model::TableKind::cubic}) {
    Builder builder("table");
    const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
    const std::vector<double> points{0, 1, 2, 4}, values{0, 2, 1, 1.5};
    const auto road = builder.table("road", points, values, kind);
    builder.dynamics("x", 1);
    builder.dynamics("y", 3 * road(x) - builder.sign(y - road(x), "above"));
    const auto system = built(builder);
    const Dcs dcs = dcs_of(system, as_step);
    const auto& table = *system.cells.front().table;
    // Breaks, and y - road(x) in each piece; a cubic spline without knots through four points is one cubic between
    // them.
    const std::size_t pieces = kind == model::TableKind::linear ? 5 : 3;
    EXPECT_EQ(dcs.surfaces.size(), table.breaks.size() + pieces);
    EXPECT_TRUE(dcs.held_symbols.empty());
    const auto expected = [&](double at) {
      double value = 0.0;
      const long cell = table.cell(at);
      const double d = at - table.constant(cell, 0);
      for (int column = table.columns - 1; column >= 1; --column) value = value * d + table.constant(cell, column);
      return value;
    };
    for (const double at : {-1.0, 0.3, 1.7, 3.0, 5.0}) {
      for (const double side : {-0.1, 0.1}) {
        const std::vector<double> place{at, expected(at) + side};
        const double rate = 3 * expected(at) - (side > 0 ? 1 : -1);
        EXPECT_NEAR(field(dcs, place, selection_at(dcs, place))[1], rate, 1e-13) << at << " " << side;
      }
    }
    // At a break nothing depends on its alpha: a kink.
    std::vector<double> on_break{1.0, 9.0};
    auto alpha = selection_at(dcs, on_break);
    for (std::size_t j = 0; j < dcs.surfaces.size(); ++j) {
      if (dcs.surfaces[j].name != "road(x) at 1") continue;
      for (const double one : {0.0, 0.5, 1.0}) {
        alpha[j] = one;
        EXPECT_NEAR(field(dcs, on_break, alpha)[1], 5.0, 1e-13);
      }
    }
  }
}

TEST(Unnesting, NamesOfTimeAreHeldAndInputsSeeThem) {
  Builder builder("held");
  const SX x = builder.state("x", {0.0}), t = builder.time();
  const SX u = builder.control("u", {0.0});
  const SX early = builder.step(1 - builder.mod(t, 2), "early");
  builder.dynamics("x", early * builder.sign(x - u));
  builder.input("u", builder.step(t - 3));
  const Dcs dcs = dcs_of(built(builder), as_step);
  EXPECT_EQ(dcs.surfaces.size(), 1u);
  ASSERT_EQ(dcs.held_symbols.size(), 3u);
  EXPECT_EQ(dcs.held_symbols[0].kind, HeldSymbol::Kind::cell);
  const casadi::Function input("input", {dcs.t, dcs.held}, {dcs.input});
  for (const double held : {0.0, 1.0}) {
    EXPECT_EQ(static_cast<double>(input(std::vector<casadi::DM>{0.0, std::vector<double>{0, held, 0.5}}).front()),
              held);
  }
}

/// min of two indicators of which one has a kink: a simplex for each side of it, weighted by its alpha.
TEST(Unnesting, IndicatorsWithKinksHaveASimplexForEachSide) {
  Builder builder("indicator");
  const SX x = builder.state("x", {0.0}), y = builder.state("y", {0.0});
  builder.region(builder.abs(x), {{"x", 1}, {"y", 0}}, "near");
  builder.region(1 + y, {{"x", 0}, {"y", 2}}, "far");
  const Dcs dcs = dcs_of(built(builder), as_step);
  ASSERT_EQ(dcs.parts.size(), 3u);
  EXPECT_EQ(dcs.parts[0].form, Form::step);
  EXPECT_EQ(dcs.parts[1].form, Form::stewart);
  EXPECT_EQ(dcs.parts[2].mode_group, 0);
  const double alpha = 0.3, above = 0.6, below = 0.1;
  const std::vector<double> selection{alpha, above, 1 - above, below, 1 - below};
  const double near = alpha * above + (1 - alpha) * below;
  const auto f = field(dcs, {0, 0}, selection);
  EXPECT_NEAR(f[0], near, 1e-15);
  EXPECT_NEAR(f[1], 2 * (1 - near), 1e-15);
  const auto refused = reformulate(built(builder), as_stewart);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("indicator"), std::string::npos);
}

/// A sum of nested terms is taken apart term by term, a product only as a whole: 2^6 sides each, or 2^12.
TEST(Unnesting, TooManySidesOfAProductAreRefusedByName) {
  for (const bool is_product : {false, true}) {
    Builder builder("many");
    std::vector<SX> outer;
    const SX z = builder.state("z", {0.0});
    for (int k = 0; k < 2; ++k) {
      SX sum = z - k;
      for (int i = 0; i < 6; ++i) {
        const std::string name = "x" + std::to_string(6 * k + i);
        sum += builder.abs(builder.state(name, {0.0}));
        builder.dynamics(name, 1);
      }
      outer.push_back(builder.step(sum));
    }
    builder.dynamics("z", is_product ? outer[0] * outer[1] : (outer[0] + outer[1]) * z);
    const auto dcs = reformulate(built(builder), as_step);
    EXPECT_EQ(dcs.has_value(), !is_product);
    if (dcs) continue;
    EXPECT_EQ(dcs.error().code, ErrorCode::not_available);
    EXPECT_NE(dcs.error().message.find("the dynamics of z unfold into more than 64"), std::string::npos)
        << dcs.error().message;
  }
}

TEST(Unnesting, ModelsWithJumpsAreRefused) {
  Builder builder("jump");
  const SX x = builder.state("x", {0.0});
  builder.dynamics("x", 1);
  builder.jump(x - 1, model::Direction::up, {{"x", 0}});
  const auto dcs = reformulate(built(builder), as_step);
  ASSERT_FALSE(dcs);
  EXPECT_EQ(dcs.error().code, ErrorCode::not_available);
  EXPECT_EQ(dcs.error().remedy, "use --method event");
}

}  // namespace
}  // namespace saltus::reformulation
