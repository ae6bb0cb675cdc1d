// Every refusal of a model: what it says, where, and what to do.
#include <limits>

#include "model_text.hpp"

namespace saltus::model {
namespace {

struct Expected_ {
  ErrorCode code;
  std::string message;  ///< part of it
  std::string remedy;   ///< part of it
  int line, column;
};

void expect(const Error& error, const Expected_& expected) {
  EXPECT_EQ(error.code, expected.code) << to_text(error);
  EXPECT_NE(error.message.find(expected.message), std::string::npos) << to_text(error);
  EXPECT_NE(error.remedy.find(expected.remedy), std::string::npos) << to_text(error);
  EXPECT_EQ(error.location.line, expected.line) << to_text(error);
  EXPECT_EQ(error.location.column, expected.column) << to_text(error);
  EXPECT_EQ(error.location.file, "model.toml");
}

TEST(Errors, UnknownNames) {
  expect(refused({.parameters = {{"friction", "1"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "1 + fricton*x"}}}),
         {ErrorCode::unknown_name, "unknown name 'fricton'", "'friction'", 3, 25});
  expect(refused({.parameters = {{"a", "1"}, {"b", "2*aa"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "a + b"}}}),
         {ErrorCode::unknown_name, "unknown name 'aa'", "'a'", 2, 23});
}

TEST(Errors, NamesWithTwoMeanings) {
  expect(refused({.parameters = {{"x", "1"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "1"}}}),
         {ErrorCode::invalid_model, "'x' is already a parameter (line 1) and cannot be a state", "rename", 2, 1});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "1"}}, .outputs = {{"x", "2"}}}),
         {ErrorCode::invalid_model, "'x' is already a state", "rename", 3, 1});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "1"}}, .events = {{"a", "x"}, {"a", "x - 1"}}}),
         {ErrorCode::invalid_model, "'a' is already an event", "rename", 4, 1});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "1"}}, .events = {{"event2", "x"}, {"", "x - 1"}}}),
         {ErrorCode::invalid_model, "'event2' is already an event", "rename", 4, 1});
}

TEST(Errors, ReservedAndMalformedNames) {
  for (const char* name : {"t", "pi", "sin", "max", "and", "otherwise"}) {
    expect(refused({.parameters = {{name, "1"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "1"}}}),
           {ErrorCode::invalid_model, "is reserved", "another name", 1, 1});
  }
  expect(refused({.states = {{"2x", "0"}}, .dynamics = {{"2x", "1"}}}),
         {ErrorCode::invalid_model, "'2x' cannot name a state", "letters, digits", 1, 1});
}

TEST(Errors, Cycles) {
  expect(refused({.states = {{"x", "0"}},
                  .definitions = {{"a", "b + 1"}, {"b", "2*c"}, {"c", "x + b"}},
                  .dynamics = {{"x", "a"}}}),
         {ErrorCode::invalid_model, "b -> c -> b", "break the cycle", 4, 25});
  expect(refused({.states = {{"x", "0"}},
                  .definitions = {{"a", "s"}},
                  .switching = {{"s", "a - 1"}},
                  .dynamics = {{"x", "a"}}}),
         {ErrorCode::invalid_model, "s -> a -> s", "break the cycle", 2, 21});
  expect(refused({.states = {{"x", "0"}}, .definitions = {{"a", "a > 1"}}, .dynamics = {{"x", "if(a, 1, 2)"}}}),
         {ErrorCode::invalid_model, "found the condition 'a'", "", 2, 21});
  expect(refused({.parameters = {{"a", "b"}, {"b", "1"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "a"}}}),
         {ErrorCode::invalid_model, "'b' is used before it is declared", "order", 1, 21});
}

TEST(Errors, StatesAndTheirRightHandSides) {
  expect(refused({.states = {{"x", "0"}, {"y", "0"}}, .dynamics = {{"x", "1"}}}),
         {ErrorCode::invalid_model, "'y' has no right-hand side", "[dynamics]", 2, 1});
  expect(refused({.states = {{"velocity", "0"}}, .dynamics = {{"velocty", "1"}}}),
         {ErrorCode::unknown_name, "found 'velocty'", "'velocity'", 2, 1});
  expect(refused({.parameters = {{"k", "0"}}, .states = {{"x", "0"}}, .dynamics = {{"k", "1"}}}),
         {ErrorCode::unknown_name, "found 'k', which is a parameter", "", 3, 1});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "1"}, {"x", "2"}}}),
         {ErrorCode::invalid_model, "two right-hand sides", "sum", 3, 1});
  const Error error = refused({.parameters = {{"k", "0"}}});
  EXPECT_NE(error.message.find("no states"), std::string::npos);
}

TEST(Errors, ValuesOfConstants) {
  expect(refused({.parameters = {{"a", "0"}, {"b", "1/a"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "b"}}}),
         {ErrorCode::invalid_model, "'b' is inf", "parameters in it", 2, 22});
  expect(refused({.parameters = {{"a", "x"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "a"}}}),
         {ErrorCode::invalid_model, "cannot depend on 'x', which is a state", "definition", 1, 21});
  expect(refused({.parameters = {{"a", "2*t"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "a"}}}),
         {ErrorCode::invalid_model, "cannot depend on the time", "", 1, 23});
  expect(refused({.states = {{"x", "log(0 - 1)"}}, .dynamics = {{"x", "1"}}}),
         {ErrorCode::invalid_model, "the initial value of state 'x' is", "check", 1, 21});
  expect(refused({.states = {{"x", "1"}, {"y", "2*x"}}, .dynamics = {{"x", "1"}, {"y", "1"}}}),
         {ErrorCode::invalid_model, "the initial value of state 'y' must be a constant", "parameters", 2, 22});
}

TEST(Errors, Bounds) {
  Description description = describe({.states = {{"x", "1"}}, .dynamics = {{"x", "1"}}});
  description.states[0].lower = parsed("2", {"model.toml", 7, 3});
  description.states[0].upper = parsed("1", {"model.toml", 7, 8});
  auto system = build(description);
  ASSERT_FALSE(system.has_value());
  EXPECT_NE(system.error().message.find("exclude each other"), std::string::npos);
  description.states[0].upper = parsed("x + 3", {"model.toml", 7, 8});
  system = build(description);
  ASSERT_FALSE(system.has_value());
  expect(system.error(), {ErrorCode::invalid_model, "the upper bound of state 'x' must be a constant", "", 7, 10});
  description.states[0].upper = parsed("3", {"model.toml", 7, 8});
  system = build(description);
  ASSERT_TRUE(system.has_value());
  EXPECT_EQ(system->warnings, Names{"model.toml:1: the initial value 1 of state 'x' lies outside its bounds [2, 3]"});
  EXPECT_EQ(system->state_lower, std::vector<double>{2.0});
}

TEST(Errors, ConstantSwitchingFunctions) {
  expect(refused({.parameters = {{"k", "1"}},
                  .states = {{"x", "0"}},
                  .switching = {{"s", "k - 3"}},
                  .dynamics = {{"x", "sign(s)"}}}),
         {ErrorCode::invalid_model, "'s' is constant", "depend on a state", 3, 23});
  expect(refused({.parameters = {{"k", "0"}},
                  .states = {{"x", "0"}},
                  .switching = {{"s", "k*x + 1"}},
                  .dynamics = {{"x", "s"}}}),
         {ErrorCode::invalid_model, "'s' is constant", "", 3, 25});
}

TEST(Errors, NumbersAndConditionsExchanged) {
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "1 + (x > 0)"}}}),
         {ErrorCode::invalid_model, "expected a number, found the condition '(x>0)'", "if(condition, 1, 0)", 2, 28});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "if(x, 1, 2)"}}}),
         {ErrorCode::invalid_model, "expected a condition, found the number 'x'", "x > 0", 2, 24});
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "if(x > 0 and 1, 1, 2)"}}}),
         {ErrorCode::invalid_model, "expected a condition, found the number '1'", "1 > 0", 2, 34});
  expect(refused({.states = {{"x", "0"}}, .switching = {{"s", "x > 1"}}, .dynamics = {{"x", "s"}}}),
         {ErrorCode::invalid_model, "expected a number", "", 2, 23});
}

TEST(Errors, EqualityOfWhatMoves) {
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "if(x == 1, 1, 0)"}}}),
         {ErrorCode::invalid_model, "== and !=", "abs(x - a)", 2, 26});
}

TEST(Errors, UsesOfOutputsEventsAndInputs) {
  expect(refused({.states = {{"x", "0"}}, .dynamics = {{"x", "y"}}, .outputs = {{"y", "x"}}}),
         {ErrorCode::invalid_model, "'y' is an output", "definition", 2, 21});
  expect(refused({.states = {{"x", "0"}},
                  .controls = {{"force", "0"}},
                  .dynamics = {{"x", "force"}},
                  .inputs = {{"farce", "t"}}}),
         {ErrorCode::unknown_name, "found 'farce'", "'force'", 4, 1});
  expect(
      refused({.states = {{"x", "0"}}, .controls = {{"u", "0"}}, .dynamics = {{"x", "u"}}, .inputs = {{"u", "2*x"}}}),
      {ErrorCode::invalid_model, "the input of 'u' depends on a state", "[definitions]", 4, 22});
}

TEST(Errors, Overrides) {
  const ModelText text{.parameters = {{"mu", "1"}}, .states = {{"x", "0"}}, .dynamics = {{"x", "mu"}}};
  const Error unknown = refused(text, {set("mue", "1")});
  EXPECT_EQ(unknown.code, ErrorCode::unknown_name);
  EXPECT_NE(unknown.remedy.find("'mu'"), std::string::npos);
  EXPECT_EQ(unknown.context, Names{"in --set mue"});
  EXPECT_NE(refused(text, {set("mu", "2*x")}).message.find("expected constants, found 'x'"), std::string::npos);
  EXPECT_NE(refused(text, {set("mu", "1/0")}).message.find("not a finite number"), std::string::npos);
}

TEST(Warnings, UnusedNamesWithTheirLine) {
  const System system = built({.parameters = {{"a", "1"}, {"b", "2"}, {"c", "b"}},
                               .states = {{"x", "0"}},
                               .controls = {{"u", "0"}},
                               .definitions = {{"d", "x"}},
                               .dynamics = {{"x", "c"}}});
  EXPECT_EQ(system.warnings,
            (Names{"model.toml:1: parameter 'a' is never used", "model.toml:5: control 'u' is never used",
                   "model.toml:6: definition 'd' is never used"}));
}

TEST(Errors, UnusedDefinitionsAreCheckedToo) {
  expect(refused({.states = {{"x", "0"}}, .definitions = {{"d", "x + yy"}}, .dynamics = {{"x", "1"}}}),
         {ErrorCode::unknown_name, "'yy'", "", 2, 25});
}

}  // namespace
}  // namespace saltus::model
