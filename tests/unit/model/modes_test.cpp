// [[modes]]: regions, their coverage, and the right-hand sides they add up to.
#include <cmath>

#include "model_text.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

struct ModeText {
  std::string when;
  Table dynamics;
  std::string group{};
};

Description with_modes(const ModelText& text, const std::vector<ModeText>& modes) {
  Description description = describe(text);
  int line = 100;
  for (const auto& [when, dynamics, group] : modes) {
    ModeDescription mode;
    mode.location = {"model.toml", ++line, 1};
    mode.group = group;
    mode.when = parsed(when, {"model.toml", line, 9});
    for (const auto& [name, rate] : dynamics)
      mode.dynamics.push_back({name, parsed(rate, mode.location), mode.location});
    description.modes.push_back(mode);
  }
  return description;
}

System built_modes(const ModelText& text, const std::vector<ModeText>& modes) {
  auto system = build(with_modes(text, modes));
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

Error refused_modes(const ModelText& text, const std::vector<ModeText>& modes) {
  auto system = build(with_modes(text, modes));
  EXPECT_FALSE(system.has_value()) << "the model was accepted";
  return system ? Error{} : system.error();
}

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

const ModelText plane{.states = {{"x", "0.5"}, {"y", "0.5"}}, .switching = {{"c1", "x"}, {"c2", "y"}}};

TEST(Modes, AUnionOfRegionsAndTheRest) {
  const System system = built_modes(plane, {{"(c1 > 0 and c2 > 0) or (c1 < 0 and c2 < 0)", {{"x", "2"}, {"y", "3"}}},
                                            {"otherwise", {{"x", "-1"}, {"y", "x"}}}});
  EXPECT_EQ(f_at(system, {1, 1}), (std::vector<double>{2, 3}));
  EXPECT_EQ(f_at(system, {-1, -1}), (std::vector<double>{2, 3}));
  EXPECT_EQ(f_at(system, {1, -1}), (std::vector<double>{-1, 1}));
  EXPECT_EQ(f_at(system, {-1, 1}), (std::vector<double>{-1, -1}));
  ASSERT_EQ(system.mode_groups.size(), 1U);
  EXPECT_EQ(system.mode_groups[0].regions, 2);
  EXPECT_EQ(columns(system), (Names{"c1", "c2"}));
  EXPECT_TRUE(system.warnings.empty());
  // In between: the multi-affine polynomial of the region.
  const double a = 0.25, b = 0.75, here = a * b + (1 - a) * (1 - b);
  EXPECT_NEAR(values(system, system.f, {0, 0}, {a, b})[0], 2 * here - (1 - here), 1e-15);
}

TEST(Modes, AddToDynamicsAndToOtherGroups) {
  const System system = built_modes({.states = {{"x", "1"}, {"y", "1"}}, .dynamics = {{"x", "10"}}},
                                    {{"x > 0", {{"x", "1"}}, "first"},
                                     {"y < 0", {{"y", "5"}}, "second"},
                                     {"x < 0", {{"x", "2"}}, "first"},
                                     {"y > 0", {{"x", "100"}, {"y", "7"}}, "second"}});
  EXPECT_EQ(f_at(system, {1, 1}), (std::vector<double>{111, 7}));
  EXPECT_EQ(f_at(system, {-1, -1}), (std::vector<double>{12, 5}));
  EXPECT_EQ(f_at(system, {-1, 1}), (std::vector<double>{112, 7}));
  ASSERT_EQ(system.mode_groups.size(), 2U);
  EXPECT_EQ(system.mode_groups[1].name, "second");
}

TEST(Modes, AbsentStatesGetZeroAndInactiveModesDoNotSpreadNan) {
  const System system = built_modes({.states = {{"x", "1"}, {"y", "1"}}},
                                    {{"x > 0", {{"x", "log(x)"}, {"y", "1"}}}, {"x < 0", {{"x", "sqrt(-x)"}}}});
  EXPECT_EQ(f_at(system, {std::exp(1.0), 0}), (std::vector<double>{1, 1}));
  EXPECT_EQ(f_at(system, {-4, 0}), (std::vector<double>{2, 0}));
}

TEST(Modes, NonsmoothTermsInsideAMode) {
  const System system =
      built_modes({.states = {{"x", "1"}, {"y", "1"}}},
                  {{"x > 0", {{"x", "-sign(y)"}, {"y", "abs(y)"}}}, {"otherwise", {{"y", "if(x > 0, 9, 4)"}}}});
  EXPECT_EQ(f_at(system, {1, -2}), (std::vector<double>{1, 2}));
  EXPECT_EQ(f_at(system, {-1, -2}), (std::vector<double>{0, 4}));
}

TEST(Modes, TheStatedFormIsTheSameAsIf) {
  const System modes =
      built_modes({.states = {{"x", "1"}}}, {{"x > 0", {{"x", "3 - x"}}}, {"otherwise", {{"x", "x + 2"}}}});
  const System text = built({.states = {{"x", "1"}}, .dynamics = {{"x", "if(x > 0, 3 - x, x + 2)"}}});
  for (const double alpha : {0.0, 0.3, 0.5, 1.0}) {
    EXPECT_EQ(value(modes, modes.f, {0.1}, {alpha}), value(text, text.f, {0.1}, {alpha})) << alpha;
  }
}

TEST(Modes, ParallelThresholdsNeedNoImpossiblePatterns) {
  for (const auto& [low, middle, high] :
       {std::tuple{"x < 1", "x > 1 and x < 2", "x > 2"}, std::tuple{"3 - 3*x > 0", "x > 1 and 2*x < 4", "4 - 2*x < 0"},
        std::tuple{"1e-9 > x", "x > 1e-9 and x < 2e-9", "x > 2e-9"}}) {
    const System system =
        built_modes({.states = {{"x", "0"}}}, {{low, {{"x", "10"}}}, {middle, {{"x", "20"}}}, {high, {{"x", "30"}}}});
    EXPECT_EQ(f_at(system, {-5})[0], 10.0);
    EXPECT_EQ(f_at(system, {5})[0], 30.0);
    EXPECT_EQ(system.switching.size(), 2U);
  }
}

TEST(Modes, EqualButMisorderedThresholdsAreUncovered) {
  // Between 1 and 2 nothing holds.
  const Error error = refused_modes({.states = {{"x", "0"}}}, {{"x < 1", {{"x", "1"}}}, {"x > 2", {{"x", "2"}}}});
  expect_contains(error.message, "1 sign pattern: 1-x < 0, x-2 < 0");
  EXPECT_EQ(error.location.line, 102);
}

TEST(Modes, UncoveredPatternsAreListed) {
  const Error error = refused_modes(plane, {{"c1 > 0 and c2 > 0", {{"x", "1"}, {"y", "1"}}}});
  expect_contains(error.message, "3 sign patterns: c1 > 0, c2 < 0; c1 < 0, c2 > 0; c1 < 0, c2 < 0");
  expect_contains(error.remedy, "otherwise");
  EXPECT_EQ(error.location.line, 101);
}

TEST(Modes, PatternsCoveredTwiceAreListed) {
  const Error error = refused_modes(plane, {{"c1 > 0", {{"x", "1"}, {"y", "1"}}}, {"c2 > 0", {{"x", "1"}}}});
  expect_contains(error.message, "overlaps the mode in line 101");
  expect_contains(error.message, "1 sign pattern: c1 > 0, c2 > 0");
  EXPECT_EQ(error.location.line, 102);
}

TEST(Modes, ManyPatternsAreCountedAndTenAreListed) {
  ModelText text;
  std::string all;
  for (int i = 0; i < 40; ++i) {
    const std::string name = "x" + std::to_string(i);
    text.states.push_back({name, "1"});
    text.dynamics.push_back({name, "0"});
    all += (i > 0 ? " and " : "") + name + " > 0";
  }
  const Error error = refused_modes(text, {{all, {{"x0", "1"}}}});
  expect_contains(error.message, "1099511627775 sign patterns");  // 2^40 - 1
  expect_contains(error.message, "; …");
  const System system = built_modes(text, {{all, {{"x0", "1"}}}, {"otherwise", {{"x0", "2"}}}});
  EXPECT_EQ(f_at(system, std::vector<double>(40, 1.0))[0], 1.0);
  EXPECT_EQ(f_at(system, std::vector<double>(40, -1.0))[0], 2.0);
}

TEST(Modes, OtherwiseStandsAnywhereOnceAndMustHoldSomewhere) {
  const ModelText line{.states = {{"x", "1"}}};
  const System first = built_modes(line, {{"otherwise", {{"x", "1"}}}, {"x > 0", {{"x", "2"}}}});
  EXPECT_EQ(f_at(first, {-1})[0], 1.0);
  EXPECT_EQ(f_at(first, {1})[0], 2.0);
  expect_contains(
      refused_modes(line, {{"x > 0", {{"x", "1"}}}, {"x < 0", {{"x", "2"}}}, {"otherwise", {{"x", "3"}}}}).message,
      "nothing is left for 'otherwise'");
  const Error twice =
      refused_modes(line, {{"x > 0", {{"x", "1"}}}, {"otherwise", {{"x", "2"}}}, {"otherwise", {{"x", "3"}}}});
  expect_contains(twice.message, "two modes 'otherwise'");
  EXPECT_EQ(twice.location.line, 103);
}

TEST(Modes, AConstantConditionFoldsAndItsModeIsWarnedOf) {
  const System system =
      built_modes({.parameters = {{"p", "2"}}, .states = {{"x", "1"}}},
                  {{"p > 1 and x > 0", {{"x", "1"}}}, {"p < 1 and x > 5", {{"x", "7"}}}, {"otherwise", {{"x", "2"}}}});
  EXPECT_EQ(f_at(system, {1})[0], 1.0);
  EXPECT_EQ(f_at(system, {-1})[0], 2.0);
  ASSERT_EQ(system.warnings.size(), 1U);
  expect_contains(system.warnings[0], "model.toml:102: this mode never holds");
}

TEST(Modes, AStateThatNothingMentionsIsAnError) {
  const Error error =
      refused_modes({.states = {{"x", "1"}, {"y", "1"}}}, {{"x > 0", {{"x", "1"}}}, {"otherwise", {{"x", "2"}}}});
  expect_contains(error.message, "'y' has no right-hand side");
}

TEST(Modes, NamesAreChecked) {
  const Error state = refused_modes({.states = {{"speed", "1"}}}, {{"speed > 0", {{"sped", "1"}}}});
  expect_contains(state.remedy, "speed");
  EXPECT_EQ(state.code, ErrorCode::unknown_name);
  const Error condition = refused_modes({.states = {{"x", "1"}}}, {{"z > 0", {{"x", "1"}}}});
  expect_contains(condition.message, "unknown name 'z'");
  expect_contains(refused_modes({.states = {{"x", "1"}}}, {{"x + 1", {{"x", "1"}}}}).message, "expected a condition");
}

Description with_indicators(const std::string& second) {
  Description description = with_modes({.states = {{"x", "1"}}}, {{"x > 0", {{"x", "1"}}}, {"x < 0", {{"x", "2"}}}});
  description.modes[0].when = nullptr;
  description.modes[0].indicator = parsed("x^2", {});
  description.modes[1].when = nullptr;
  description.modes[1].indicator = parsed(second, {});
  return description;
}

TEST(Modes, IndicatorsAreReadAndChecked) {
  Description description = with_indicators("(x - 1)^2");
  auto system = build(description);
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  ASSERT_EQ(system->mode_groups.size(), 1U);
  EXPECT_EQ(system->mode_groups[0].first, 0);
  EXPECT_EQ(system->mode_groups[0].mode_names, (std::vector<std::string>{"mode1", "mode2"}));
  ASSERT_EQ(system->switching.size(), 2U);
  EXPECT_EQ(system->switching[1].role, SwitchingRole::region);
  EXPECT_TRUE(system->columns.empty());
  description.modes[1].name = "mode1";
  system = build(description);
  ASSERT_FALSE(system.has_value());
  expect_contains(system.error().message, "modes without a name are mode1");
  description.modes[0].name = description.modes[1].name = "left";
  system = build(description);
  ASSERT_FALSE(system.has_value());
  expect_contains(system.error().message, "two modes are named 'left'");
  system = build(with_indicators("(x - w)^2"));
  ASSERT_FALSE(system.has_value());
  expect_contains(system.error().message, "unknown name 'w'");
  description = with_indicators("x");
  description.modes[1].indicator = nullptr;
  description.modes[1].when = parsed("x > 0", {});
  system = build(description);
  ASSERT_FALSE(system.has_value());
  expect_contains(system.error().message, "in one group");
}

TEST(Modes, FromCpp) {
  Builder model("modes");
  const casadi::SX x = model.state("x", {0.5}), y = model.state("y", {0.5});
  model.dynamics("y", casadi::SX(1.0));
  model.mode(greater(x, 1.0), {{"x", casadi::SX(3.0)}});
  model.otherwise({{"x", y}, {"y", casadi::SX(2.0)}});
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(f_at(*system, {2, 7}), (std::vector<double>{3, 1}));
  EXPECT_EQ(f_at(*system, {0, 7}), (std::vector<double>{7, 3}));
  EXPECT_EQ(f_at(*model.build(), {0, 7}), (std::vector<double>{7, 3})) << "building again adds nothing";
  Builder gap("gap");
  const casadi::SX z = gap.state("z", {0.5});
  gap.mode(greater(z, 1.0), {{"z", casadi::SX(3.0)}}, "only");
  const auto refused_gap = gap.build();
  ASSERT_FALSE(refused_gap.has_value());
  expect_contains(refused_gap.error().message, "of group 'only' leave uncovered 1 sign pattern");
}

}  // namespace
}  // namespace saltus::model
