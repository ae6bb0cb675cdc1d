// Recognition of step, sign, abs, max, min and if; their switching functions, names and sharing.
#include <cmath>

#include "model_text.hpp"

namespace saltus::model {
namespace {

TEST(Recognition, StepIsTheSelectionOfItsArgument) {
  const System system = built({.states = {{"x", "1"}}, .dynamics = {{"x", "step(x - 2)"}}});
  ASSERT_EQ(system.switching.size(), 1U);
  EXPECT_EQ(system.switching[0].name, "x-2");
  EXPECT_EQ(system.switching[0].role, SwitchingRole::listed);
  EXPECT_EQ(value(system, system.switching[0].psi, {5.0}, {0.0}), 3.0);
  for (const double alpha : {0.0, 0.3, 1.0}) EXPECT_EQ(value(system, system.f, {5.0}, {alpha}), alpha);
}

TEST(Recognition, UnnamedFunctionsAreNamedByTheirTextAsWritten) {
  const System system =
      built({.states = {{"x", "1"}}, .dynamics = {{"x", "if(x > 1e6 + 0.50, 1, 2) + sign( x - 2.0 )"}}});
  EXPECT_EQ(columns(system), (Names{"x-(1e6+0.50)", "x-2.0"}));
}

TEST(Recognition, SignIsTwoStepsMinusOne) {
  const System system = built({.states = {{"x", "1"}}, .dynamics = {{"x", "2 - sign(x)"}}});
  EXPECT_EQ(columns(system), Names{"x"});
  EXPECT_EQ(value(system, system.f, {5.0}, {1.0}), 1.0);
  EXPECT_EQ(value(system, system.f, {5.0}, {0.0}), 3.0);
  EXPECT_EQ(value(system, system.f, {5.0}, {0.25}), 2.5);
  EXPECT_TRUE(system.multi_affine);
}

TEST(Recognition, NarrowFunctionsOfTheStateAreNoConstants) {
  for (const std::string centre : {"30", "1000", "-65"}) {
    const System system =
        built({.states = {{"x", "1"}}, .dynamics = {{"x", "if(exp(-(x - (" + centre + "))^2) > 0.5, 1, 0)"}}});
    EXPECT_EQ(system.switching.size(), 1U) << centre;
  }
}

TEST(Recognition, StatesKeepTheOrderOfTheFile) {
  const System system = built({.states = {{"z", "1"}, {"a", "2"}}, .dynamics = {{"a", "10"}, {"z", "20"}}});
  EXPECT_EQ(system.state_names, (Names{"z", "a"}));
  EXPECT_EQ(system.initial_state, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(f_at(system, {0.0, 0.0}), (std::vector<double>{20.0, 10.0}));
}

TEST(Recognition, TheSameArgumentIsTheSameFunction) {
  const System system = built({.states = {{"x", "1"}, {"y", "0"}},
                               .dynamics = {{"x", "sign(x - y) + step(3*x - 3*y)"},
                                            {"y", "if(x > y, 1, 0) + sign(y - x) + sign((x - y)*7/3)"}}});
  EXPECT_EQ(columns(system), Names{"x-y"});
  EXPECT_EQ(values(system, system.f, {0.0, 0.0}, {1.0}), (std::vector<double>{2.0, 1.0 - 1.0 + 1.0}));
  EXPECT_EQ(values(system, system.f, {0.0, 0.0}, {0.0}), (std::vector<double>{-1.0, 0.0 + 1.0 - 1.0}));
}

TEST(Recognition, NearlyEqualThresholdsStayApart) {
  const System system = built({.states = {{"x", "1"}}, .dynamics = {{"x", "step(x - 0.01) + step(x - 0.0100000001)"}}});
  EXPECT_EQ(system.switching.size(), 2U);
}

TEST(Recognition, ThresholdsOfAnySizeStayApart) {
  const System system =
      built({.states = {{"x", "1"}},
             .dynamics = {{"x", "step(x - 1e20) + step(x - 2e20) + step(x - 1e-20) + step(x - 2e-20)"}},
             .events = {{"", "x > 1e30"}}});
  EXPECT_EQ(columns(system), (Names{"x-1e20", "x-2e20", "x-1e-20", "x-2e-20"}));
  EXPECT_TRUE(system.warnings.empty());
}

TEST(Recognition, EqualityIsDecidedWithTheParametersValues) {
  const ModelText text{.parameters = {{"a", "2"}, {"b", "1"}},
                       .states = {{"x", "1"}},
                       .dynamics = {{"x", "step(x - a) + step(x - 2*b)"}}};
  EXPECT_EQ(built(text).switching.size(), 1U);
  EXPECT_EQ(built(text, {set("a", "3")}).switching.size(), 2U);
}

TEST(Recognition, SharingSurvivesArgumentsWithALimitedDomain) {
  const System system = built(
      {.states = {{"x", "1"}}, .dynamics = {{"x", "step(log(x) - 1) + step(2*log(x) - 2) + step(log(x^2) - 2)"}}});
  EXPECT_EQ(columns(system), Names{"log(x)-1"});
}

TEST(Recognition, PowersWithAParameterAreComparedToo) {
  const System system =
      built({.parameters = {{"k", "2"}},
             .states = {{"x", "1"}},
             .dynamics = {{"x", "step(x^k - 4) + 3*step(12 - 3*x^k) + step(x^k - 5) + step(x^3 - 4)"}}});
  EXPECT_EQ(columns(system), (Names{"x^k-4", "x^k-5", "x^3-4"}));
}

TEST(Recognition, NamesComeFromTheText) {
  const System system = built({.states = {{"x", "1"}, {"y", "2"}, {"z", "3"}},
                               .definitions = {{"level", "x + y"}},
                               .dynamics = {{"x", "if(x > 2 * y, 1, 0) + if(y < z, 1, 0)"},
                                            {"y", "if(x >= y + z, 1, 0) + step( 3*z - 1 )"},
                                            {"z", "sign(level - 7) + if(x*y <= -1, 1, 0)"}}});
  EXPECT_EQ(columns(system), (Names{"x-2*y", "z-y", "x-(y+z)", "3*z-1", "level-7", "-1-x*y"}));
}

TEST(Recognition, NamedFunctionsComeFirstAndKeepTheirScaling) {
  const System system = built({.states = {{"v", "0"}, {"w", "0"}},
                               .switching = {{"slip", "3*v - 0.6"}, {"late", "w - 1"}},
                               .dynamics = {{"v", "sign(w) - sign(v - 0.2)"}, {"w", "sign(late) + step(slip)"}}});
  EXPECT_EQ(columns(system), (Names{"slip", "late", "w"}));
  const auto& slip = system.switching[static_cast<std::size_t>(system.columns[0].function)];
  EXPECT_TRUE(slip.named);
  EXPECT_NEAR(value(system, slip.psi, {1.2, 0.0}, {0.0, 0.0, 0.0}), 3.0, 1e-15);
}

TEST(Recognition, ANamedFunctionTakesOverFromAnInnerTerm) {
  const System system = built({.states = {{"x", "0"}},
                               .switching = {{"gap", "abs(x) - 1"}, {"side", "-2*x"}},
                               .dynamics = {{"x", "sign(side) + sign(gap)"}}});
  EXPECT_EQ(columns(system), (Names{"gap", "side"}));
  // x = 3: side = -6 < 0 and gap = 2 > 0.
  EXPECT_EQ(f_at(system, {3.0}), std::vector<double>{0.0});
  EXPECT_EQ(f_at(system, {-3.0}), std::vector<double>{2.0});
  EXPECT_EQ(f_at(system, {-0.5}), std::vector<double>{0.0});
  EXPECT_EQ(system.columns[1].orientation, -1);
  const auto& side = system.switching[static_cast<std::size_t>(system.columns[1].function)];
  EXPECT_EQ(std::abs(value(system, side.psi, {3.0}, {0.0, 0.0})), 6.0);
}

TEST(Recognition, ASecondNameOfAFunctionIsAnAliasWithItsOwnColumn) {
  const System system = built({.states = {{"v", "0"}},
                               .switching = {{"slip", "v - 0.2"}, {"stick", "1 - 5*v"}},
                               .dynamics = {{"v", "-sign(slip) - step(stick)"}}});
  ASSERT_EQ(system.switching.size(), 1U);
  EXPECT_EQ(columns(system), (Names{"slip", "stick"}));
  EXPECT_EQ(system.columns[0].orientation, +1);
  EXPECT_EQ(system.columns[1].orientation, -1);
  EXPECT_EQ(system.columns[1].function, system.columns[0].function);
  EXPECT_EQ(value(system, system.f, {0.0}, {1.0}), -1.0);
  EXPECT_EQ(value(system, system.f, {0.0}, {0.0}), 0.0);
  ASSERT_EQ(system.warnings.size(), 1U);
  EXPECT_NE(system.warnings[0].find("model.toml:3: "), std::string::npos) << system.warnings[0];
  EXPECT_NE(system.warnings[0].find("'stick'"), std::string::npos);
}

TEST(Recognition, ASwitchingNameStandsForItsExpression) {
  const System system =
      built({.states = {{"v", "0"}}, .switching = {{"slip", "v - 0.25"}}, .dynamics = {{"v", "4*slip"}}});
  EXPECT_EQ(f_at(system, {1.25}), std::vector<double>{4.0});
  EXPECT_TRUE(system.warnings.empty());
}

TEST(Recognition, AbsMaxMinSelectTheirBranchExactly) {
  const System system =
      built({.states = {{"x", "0"}, {"y", "0"}}, .dynamics = {{"x", "max(x, y)"}, {"y", "min(x, y) + abs(x)"}}});
  for (const double x : {-1e16, -1.0, 0.1, 1e16}) {
    for (const double y : {-3.0, 0.3, 1e16 + 2}) {
      const auto f = f_at(system, {x, y});
      if (x == y) continue;
      EXPECT_EQ(f[0], std::max(x, y));
      EXPECT_EQ(f[1], std::min(x, y) + std::abs(x));
    }
  }
}

TEST(Recognition, IfDoesNotSpreadNanOfTheOtherBranch) {
  const System system = built({.states = {{"x", "1"}},
                               .dynamics = {{"x", "if(x > 0, sqrt(x), 1/(x - x) + log(x))"}},
                               .outputs = {{"root", "max(sqrt(x), sqrt(-x) + sqrt(x))"}}});
  EXPECT_EQ(f_at(system, {4.0}), std::vector<double>{2.0});
  EXPECT_EQ(value(system, system.f_as_written, {4.0}, {1.0, 1.0}), 2.0);
}

TEST(Recognition, NestedTermsAreOneFunctionEach) {
  const System system =
      built({.states = {{"v", "0"}, {"x", "0"}}, .dynamics = {{"v", "-sign(v + max(x, 0))"}, {"x", "1"}}});
  ASSERT_EQ(system.switching.size(), 2U);
  EXPECT_EQ(columns(system), Names{"v+max(x,0)"});
  EXPECT_EQ(system.switching[0].role, SwitchingRole::kink);
  EXPECT_EQ(system.switching[1].inner, std::vector<int>{0});
  for (const double v : {-2.0, 0.5}) {
    for (const double x : {-1.0, 1.0}) {
      EXPECT_EQ(f_at(system, {v, x})[0], v + std::max(x, 0.0) > 0.0 ? -1.0 : 1.0);
    }
  }
}

TEST(Recognition, SaturationAndMaxOfThree) {
  const System system =
      built({.states = {{"x", "0"}, {"y", "0"}, {"z", "0"}},
             .dynamics = {{"x", "min(max(x, -1), 1)"}, {"y", "max(max(x, y), z)"}, {"z", "abs(abs(x) - 1)"}}});
  for (const double x : {-3.5, -0.25, 0.75, 2.5}) {
    for (const double y : {-1.5, 0.5}) {
      for (const double z : {-2.25, 0.625, 9.0}) {
        const auto f = f_at(system, {x, y, z});
        EXPECT_EQ(f[0], std::min(std::max(x, -1.0), 1.0));
        EXPECT_EQ(f[1], std::max(std::max(x, y), z));
        EXPECT_EQ(f[2], std::abs(std::abs(x) - 1.0));
      }
    }
  }
  EXPECT_TRUE(system.columns.empty());  // all of them are kinks
}

TEST(Recognition, StepOfASelectionIsRewritten) {
  // step(2 alpha - 1) = alpha, and a product of steps compared with a number is their conjunction.
  const System system = built({.states = {{"x", "0"}, {"y", "0"}},
                               .dynamics = {{"x", "sign(sign(x))"}, {"y", "if(step(x) + step(y) > 1.5, 5, 3)"}}});
  EXPECT_EQ(columns(system), (Names{"x", "y"}));
  EXPECT_EQ(values(system, system.f, {0.0, 0.0}, {0.25, 0.5}), (std::vector<double>{-0.5, 3.0 + 2.0 * 0.125}));
}

TEST(Recognition, ChainsBeyondSixtyFourBranchesAreRefusedByName) {
  std::string inner = "x";
  for (int i = 0; i < 6; ++i) inner = "abs(" + inner + ") - 1";
  EXPECT_TRUE(build(describe({.states = {{"x", "0"}}, .dynamics = {{"x", "sign(" + inner + ")"}}})).has_value());
  const Error error = refused({.states = {{"x", "0"}}, .dynamics = {{"x", "sign(abs(" + inner + ") - 1)"}}});
  EXPECT_NE(error.message.find("64 branches"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find("abs(abs("), std::string::npos) << error.message;
  EXPECT_EQ(error.location.line, 2);
}

TEST(Recognition, DefinitionsNobodyUsesLeaveNoFunction) {
  const System system =
      built({.states = {{"x", "0"}}, .definitions = {{"idle", "sign(x - 5)"}}, .dynamics = {{"x", "sign(x)"}}});
  EXPECT_EQ(system.switching.size(), 1U);
  ASSERT_EQ(system.warnings.size(), 1U);
  EXPECT_EQ(system.warnings[0], "model.toml:2: definition 'idle' is never used");
}

}  // namespace
}  // namespace saltus::model
