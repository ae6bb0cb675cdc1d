// Conditions as polynomials, and the two inclusions.
#include <cmath>

#include "model_text.hpp"

namespace saltus::model {
namespace {

TEST(Conditions, RepeatedAlphasCountOnce) {
  // (a and b) or (a and c), with alpha_a twice: a (b + c - b c), not a b + a c - a^2 b c.
  const System system =
      built({.states = {{"a", "0"}, {"b", "0"}, {"c", "0"}},
             .dynamics = {{"a", "if((a > 0 and b > 0) or (a > 0 and c > 0), 1, 0)"}, {"b", "0"}, {"c", "0"}}});
  ASSERT_EQ(columns(system), (Names{"a", "b", "c"}));
  const double a = 0.3, b = 0.6, c = 0.9;
  EXPECT_NEAR(value(system, system.f, {0, 0, 0}, {a, b, c}), a * (b + c - b * c), 1e-15);
}

TEST(Conditions, AgreeWithTheirTruthTableAndAreMultiAffine) {
  const System system =
      built({.states = {{"x", "0"}, {"y", "0"}},
             .dynamics = {{"x", "if(not (x > 0) and y > 0 or x > 0 and not (y >= 0), 7, 2)"}, {"y", "1"}}});
  ASSERT_EQ(columns(system), (Names{"x", "y"}));
  const auto at = [&](double a, double b) { return value(system, system.f, {0, 0}, {a, b}); };
  EXPECT_EQ(at(0, 0), 2.0);
  EXPECT_EQ(at(1, 1), 2.0);
  EXPECT_EQ(at(1, 0), 7.0);
  EXPECT_EQ(at(0, 1), 7.0);
  EXPECT_NEAR(at(0.25, 0.5), 2.0 + 5.0 * (0.25 + 0.5 - 2 * 0.25 * 0.5), 1e-15);
}

TEST(Conditions, IndependentConditionsAreProductsAndSums) {
  const System system = built({.states = {{"x", "0"}, {"y", "0"}},
                               .dynamics = {{"x", "if(x > 0 and y > 0, 1, 0)"}, {"y", "if(x > 0 or y > 0, 1, 0)"}}});
  const auto f = values(system, system.f, {0, 0}, {0.25, 0.5});
  EXPECT_NEAR(f[0], 0.125, 1e-16);
  EXPECT_NEAR(f[1], 0.625, 1e-16);
}

TEST(Conditions, TautologiesFold) {
  const System system = built({.states = {{"x", "0"}}, .dynamics = {{"x", "if(x > 0 or not (x > 0), 4, 5)"}}});
  EXPECT_EQ(values(system, system.f, {0}, std::vector<double>(system.switching.size(), 0.3)), std::vector<double>{4.0});
}

TEST(Conditions, DefinitionsMayBeConditions) {
  const System system = built({.states = {{"x", "0"}},
                               .definitions = {{"on", "x > 1"}, {"off", "not on"}},
                               .dynamics = {{"x", "if(off and x < 9, 1, 2)"}}});
  EXPECT_EQ(f_at(system, {0.0})[0], 1.0);
  EXPECT_EQ(f_at(system, {3.0})[0], 2.0);
}

TEST(Conditions, ManyIndependentOnesStayCompact) {
  std::string condition;
  Table states, dynamics;
  std::vector<double> x(40, 1.0);
  for (int i = 0; i < 40; ++i) {
    const std::string name = "x" + std::to_string(i);
    states.push_back({name, "0"});
    dynamics.push_back({name, "0"});
    condition += (i > 0 ? " and " : "") + name + " > " + std::to_string(0.01 * i);
  }
  dynamics[0].second = "if(" + condition + ", 1, -1)";
  const System system = built({.states = states, .dynamics = dynamics});
  EXPECT_EQ(system.columns.size(), 40U);
  EXPECT_EQ(f_at(system, x)[0], 1.0);
  x[39] = 0.0;
  EXPECT_EQ(f_at(system, x)[0], -1.0);
}

TEST(Folding, NonsmoothFunctionsOfConstantsAreValues) {
  const System system =
      built({.parameters = {{"k", "0"}, {"m", "2"}},
             .states = {{"x", "1"}, {"y", "1"}},
             .dynamics = {{"x", "sign(0) + step(0)*10 + 100*step(k) + sign(m - 5) + abs(-3) + max(m, 7)"},
                          {"y",
                           "if(k >= 0, 1, 0) + if(k > 0, 10, 0) + if(m == 2, 100, 0) + step(k*x) + "
                           "sign(max(x, x + k) - x)"}}});
  EXPECT_TRUE(system.switching.empty());
  EXPECT_EQ(f_at(system, {5.0, 6.0}),
            (std::vector<double>{0.0 + 5.0 + 50.0 - 1.0 + 3.0 + 7.0, 1.0 + 0.0 + 100.0 + 0.5}));
}

TEST(Folding, FollowsTheOverrides) {
  const ModelText text{.parameters = {{"k", "0"}}, .states = {{"x", "1"}}, .dynamics = {{"x", "step(k*x)"}}};
  EXPECT_TRUE(built(text).switching.empty());
  EXPECT_EQ(columns(built(text, {set("k", "2")})), Names{"k*x"});
}

TEST(Inclusion, FilippovInterpolatesTheValuesAtTheCorners) {
  const ModelText text{.states = {{"v", "0"}}, .dynamics = {{"v", "if(v > 0, 4, 1)*sign(v)"}}};
  const System filippov = built(text);
  ModelText other = text;
  other.inclusion = Inclusion::aizerman_pyatnitskii;
  const System aizerman = built(other);
  for (const double alpha : {0.0, 0.25, 0.5, 1.0}) {
    const double as_written = (1.0 + 3.0 * alpha) * (2.0 * alpha - 1.0);
    EXPECT_NEAR(value(filippov, filippov.f, {0.0}, {alpha}), -1.0 + 5.0 * alpha, 1e-15);
    EXPECT_NEAR(value(filippov, filippov.f_as_written, {0.0}, {alpha}), as_written, 1e-15);
    EXPECT_NEAR(value(aizerman, aizerman.f, {0.0}, {alpha}), as_written, 1e-15);
  }
  for (const System* system : {&filippov, &aizerman}) {
    EXPECT_FALSE(system->multi_affine);
    EXPECT_EQ(system->inclusion_differences, Names{"v"});
  }
}

TEST(Inclusion, ProductsOfDifferentAlphasAreTheSameInBoth) {
  const System system =
      built({.states = {{"x", "0"}, {"y", "0"}}, .dynamics = {{"x", "sign(x)*sign(y)"}, {"y", "step(x)*y"}}});
  EXPECT_TRUE(system.multi_affine);
  EXPECT_TRUE(system.inclusion_differences.empty());
  EXPECT_NEAR(value(system, system.f, {0, 0}, {0.25, 0.75}), -0.25, 1e-16);
}

TEST(Inclusion, SmoothFunctionsOfSelectionsAreInterpolated) {
  const System system = built({.states = {{"v", "0"}, {"w", "0"}},
                               .dynamics = {{"v", "exp(sign(v)) - w*sign(w)"}, {"w", "sin(sign(v) + 2*step(w))"}}});
  EXPECT_EQ(system.inclusion_differences, (Names{"v", "w"}));
  const double a = 0.3, b = 0.8;
  EXPECT_NEAR(value(system, system.f, {0, 0}, {a, b}), a * std::exp(1.0) + (1 - a) * std::exp(-1.0), 1e-15);
  const double expected = a * b * std::sin(3.0) + a * (1 - b) * std::sin(1.0) + (1 - a) * b * std::sin(1.0) +
                          (1 - a) * (1 - b) * std::sin(-1.0);
  EXPECT_NEAR(values(system, system.f, {0, 0}, {a, b})[1], expected, 1e-15);
}

TEST(Inclusion, AgreesWhereTheBendVanishesOnTheSurface) {
  // abs(v) sign(v) is v: alpha enters as a square, but times 0 where alpha is between 0 and 1.
  const System system = built({.states = {{"v", "0"}}, .dynamics = {{"v", "-exp(-abs(v))*sign(v)"}}});
  EXPECT_FALSE(system.multi_affine);
  EXPECT_TRUE(system.inclusion_differences.empty());
}

TEST(Inclusion, ReducedBranchesDoNotSpreadNan) {
  const System system =
      built({.states = {{"v", "1"}}, .dynamics = {{"v", "if(v > 0, sqrt(v), sqrt(-v))*sign(v) + sign(v)"}}});
  EXPECT_EQ(value(system, system.f, {4.0}, {1.0}), 3.0);
  EXPECT_EQ(value(system, system.f, {-4.0}, {0.0}), -3.0);
}

TEST(Inclusion, TooManyCornersAreRefused) {
  std::string sum = "0";
  Table states, dynamics;
  for (int i = 0; i < 7; ++i) {
    const std::string name = "x" + std::to_string(i);
    states.push_back({name, "0"});
    dynamics.push_back({name, "1"});
    sum += " + sign(" + name + ")";
  }
  dynamics[2].second = "sin(" + sum + ")";
  const Error error = refused({.states = states, .dynamics = dynamics});
  EXPECT_NE(error.message.find("dynamics of x2"), std::string::npos) << error.message;
  EXPECT_EQ(error.location.line, 10);
  EXPECT_TRUE(build(describe({.states = states, .dynamics = dynamics, .inclusion = Inclusion::aizerman_pyatnitskii}))
                  .has_value());
}

}  // namespace
}  // namespace saltus::model
