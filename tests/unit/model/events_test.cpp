// [[events]], inputs, outputs and overrides.
#include "model_text.hpp"

namespace saltus::model {
namespace {

TEST(Events, AnExpressionHasNoGuards) {
  const System system =
      built({.states = {{"q", "1"}}, .dynamics = {{"q", "1"}}, .events = {{"returns", "q - 2"}, {"", "q"}}});
  ASSERT_EQ(system.events.size(), 2U);
  EXPECT_EQ(system.events[0].name, "returns");
  EXPECT_TRUE(system.events[0].named);
  EXPECT_EQ(system.events[0].guards.numel(), 0);
  EXPECT_EQ(value(system, system.events[0].value, {5.0}, {}), 3.0);
  EXPECT_EQ(system.events[1].name, "event2");
  EXPECT_FALSE(system.events[1].named);
  EXPECT_TRUE(system.switching.empty());
}

TEST(Events, AConditionIsAPolynomialInItsGuards) {
  const System system = built({.states = {{"q", "1"}, {"v", "0"}},
                               .dynamics = {{"q", "1"}, {"v", "1"}},
                               .events = {{"inside", "(q > 1 and v <= 2) or (q > 1 and t < 3)"}}});
  const UserEvent& event = system.events[0];
  ASSERT_EQ(event.guards.numel(), 3);
  EXPECT_EQ(event.true_at_equality, (std::vector<bool>{false, true, false}));
  EXPECT_EQ(values(system, event.guards, {5.0, 0.5}, {}, 1.0), (std::vector<double>{4.0, 1.5, 2.0}));
  const casadi::Function truth("truth", {event.guard_alpha}, {event.value});
  const auto at = [&](double a, double b, double c) {
    return static_cast<double>(truth(std::vector<casadi::DM>{std::vector<double>{a, b, c}}).front());
  };
  for (const double a : {0.0, 1.0}) {
    for (const double b : {0.0, 1.0}) {
      for (const double c : {0.0, 1.0}) EXPECT_EQ(at(a, b, c), (a > 0 && b > 0) || (a > 0 && c > 0) ? 1.0 : 0.0);
    }
  }
  EXPECT_TRUE(system.switching.empty());  // comparisons of events are guards, not surfaces
}

TEST(Events, GuardsMayContainSelections) {
  const System system = built({.states = {{"q", "1"}}, .dynamics = {{"q", "1"}}, .events = {{"", "q > sign(q - 1)"}}});
  EXPECT_EQ(columns(system), Names{"q-1"});
  EXPECT_EQ(value(system, system.events[0].guards, {5.0}, {1.0}), 4.0);
}

TEST(Events, AConstantConditionNeverHappensAndWarns) {
  const System system = built({.parameters = {{"armed", "0"}},
                               .states = {{"q", "1"}},
                               .dynamics = {{"q", "1"}},
                               .events = {{"alarm", "armed > 0 and q > 1"}}});
  EXPECT_EQ(system.events[0].guards.numel(), 1);
  EXPECT_TRUE(system.events[0].value.is_constant());
  EXPECT_EQ(system.warnings, Names{"model.toml:4: event 'alarm' never happens: its 'when' is constant"});
}

TEST(Inputs, DefaultToTheInitialValueAndMayDependOnTime) {
  const ModelText text{.parameters = {{"amplitude", "3"}},
                       .states = {{"x", "1"}},
                       .controls = {{"u", "0.5"}, {"w", "2*amplitude"}},
                       .dynamics = {{"x", "u + w"}},
                       .inputs = {{"u", "amplitude*t"}}};
  const System system = built(text);
  EXPECT_EQ(values(system, system.input, {0.0}, {}, 2.0), (std::vector<double>{6.0, 6.0}));
  const System fixed = built(text, {set("u", "1/4")});
  EXPECT_EQ(values(fixed, fixed.input, {0.0}, {}, 2.0), (std::vector<double>{0.25, 6.0}));
  EXPECT_EQ(fixed.control_initial, (std::vector<double>{0.25, 6.0}));
}

TEST(Overrides, ChangeParametersAndWhatDependsOnThem) {
  const ModelText text{.parameters = {{"a", "2"}, {"b", "3*a"}},
                       .states = {{"x", "b + 1"}, {"y", "a"}},
                       .dynamics = {{"x", "a*b"}, {"y", "0"}}};
  const System system = built(text, {set("a", "sqrt(16)"), set("y", "-pi")});
  EXPECT_EQ(system.parameter_values, (std::vector<double>{4.0, 12.0}));
  EXPECT_EQ(system.initial_state[0], 13.0);
  EXPECT_DOUBLE_EQ(system.initial_state[1], -3.14159265358979323846);
  EXPECT_EQ(f_at(system, {0.0, 0.0})[0], 48.0);
}

TEST(Outputs, AreRecordedInTheOrderOfTheFile) {
  const System system = built({.states = {{"x", "1"}},
                               .dynamics = {{"x", "-sign(x)"}},
                               .outputs = {{"power", "x*sign(x)"}, {"energy", "x^2/2"}}});
  EXPECT_EQ(system.output_names, (Names{"power", "energy"}));
  EXPECT_EQ(values(system, system.outputs, {3.0}, {1.0}), (std::vector<double>{3.0, 4.5}));
}

TEST(Expressions, EveryFunctionHasItsValue) {
  const System system = built({.states = {{"x", "1"}},
                               .dynamics = {{"x", "0"}},
                               .outputs = {{"a", "sin(x) + cos(x) + tan(x)"},
                                           {"b", "asin(x/3) + acos(x/3) + atan(x)"},
                                           {"c", "sinh(x) + cosh(x) + tanh(x) + exp(x)"},
                                           {"d", "log(x) + log10(x) + sqrt(x)"},
                                           {"e", "atan2(x, 2) + hypot(x, 2) + pow(x, 3)"},
                                           {"f", "2^x^2 - -x^2 + t*pi"}}});
  const double x = 0.7;
  const auto y = values(system, system.outputs, {x}, {}, 2.0);
  EXPECT_DOUBLE_EQ(y[0], std::sin(x) + std::cos(x) + std::tan(x));
  EXPECT_DOUBLE_EQ(y[1], std::asin(x / 3) + std::acos(x / 3) + std::atan(x));
  EXPECT_DOUBLE_EQ(y[2], std::sinh(x) + std::cosh(x) + std::tanh(x) + std::exp(x));
  EXPECT_DOUBLE_EQ(y[3], std::log(x) + std::log10(x) + std::sqrt(x));
  EXPECT_DOUBLE_EQ(y[4], std::atan2(x, 2) + std::hypot(x, 2.0) + x * x * x);
  EXPECT_DOUBLE_EQ(y[5], std::pow(2.0, x * x) + x * x + 2.0 * 3.14159265358979323846);
}

}  // namespace
}  // namespace saltus::model
