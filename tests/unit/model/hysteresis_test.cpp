// [[hysteresis]] on its way from a description into a system.
#include <algorithm>

#include "model_text.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/frozen_system.hpp"

namespace saltus::model {
namespace {

struct Written {
  std::string input = "v", on = "15", off = "10", initial = "0";
};

Expected<System> with(const Written& written, const std::string& speed = "12") {
  Description description = describe({.parameters = {{"a", "2"}},
                                      .states = {{"v", speed}},
                                      .dynamics = {{"v", "a*(1 + 2*turbo) + if(turbo == 1, 1, 0) + t"}}});
  HysteresisDescription turbo;
  turbo.name = "turbo";
  turbo.location = {"model.toml", 30, 1};
  turbo.input = parsed(written.input, {"model.toml", 31, 9});
  turbo.on = parsed(written.on, {"model.toml", 32, 9});
  turbo.off = parsed(written.off, {"model.toml", 33, 9});
  turbo.initial = parsed(written.initial, {"model.toml", 34, 9});
  description.hysteresis.push_back(turbo);
  return build(description, {});
}

System built_with(const Written& written, const std::string& speed = "12") {
  auto system = with(written, speed);
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

std::string refused_with(const Written& written) {
  const auto system = with(written);
  EXPECT_FALSE(system.has_value());
  return system ? "" : to_text(system.error());
}

TEST(Hysteresis, IsADiscreteStateBehindTheOthers) {
  const auto system = built_with({});
  EXPECT_EQ(system.state_names, (Names{"v", "turbo"}));
  EXPECT_EQ(system.discrete_states, (std::vector<bool>{false, true}));
  EXPECT_EQ(system.initial_state, (std::vector<double>{12.0, 0.0}));
  EXPECT_EQ(system.jumps.front().name, "turbo");
  EXPECT_TRUE(system.warnings.empty());
  EXPECT_DOUBLE_EQ(values(system, system.f, {12.0, 0.0}, {0.0, 1.0}).front(), 2.0);
}

TEST(Hysteresis, BeginsOnItsSideBeyondAThreshold) {
  EXPECT_EQ(built_with({}, "16").initial_state.back(), 1.0);
  EXPECT_EQ(built_with({}, "16").warnings.size(), 1U);
  EXPECT_EQ(built_with({.initial = "1"}, "16").warnings.size(), 0U);
  EXPECT_EQ(built_with({.initial = "1"}, "9").initial_state.back(), 0.0);
  EXPECT_EQ(built_with({.initial = "1"}, "12").initial_state.back(), 1.0);
  EXPECT_EQ(built_with({.on = "10", .off = "15"}, "9").initial_state.back(), 1.0);
  EXPECT_EQ(built_with({.on = "10", .off = "15", .initial = "1"}, "16").initial_state.back(), 0.0);
  // On a threshold nothing is decided yet.
  EXPECT_EQ(built_with({}, "15").initial_state.back(), 0.0);
}

TEST(Hysteresis, MistakesAreNamed) {
  EXPECT_NE(refused_with({.on = "a", .off = "2"}).find("are both 2"), std::string::npos);
  EXPECT_NE(refused_with({.initial = "0.5"}).find("begins with 0.5"), std::string::npos);
  EXPECT_NE(refused_with({.on = "v"}).find("`on` of the hysteresis 'turbo' depends on a state"), std::string::npos);
  EXPECT_NE(refused_with({.on = "1/0"}).find("`on` of the hysteresis 'turbo' is inf"), std::string::npos);
  EXPECT_NE(refused_with({.input = "a"}).find("has no state that moves"), std::string::npos);
  EXPECT_NE(refused_with({.input = "v + t"}).find("depends on t"), std::string::npos);
}

TEST(Hysteresis, ItsNameIsItsOwn) {
  Description description = describe({.states = {{"v", "0"}}, .dynamics = {{"v", "1"}}});
  HysteresisDescription twin;
  twin.name = "v";
  twin.location = {"model.toml", 30, 1};
  twin.input = twin.on = parsed("v", {});
  twin.off = parsed("0", {});
  description.hysteresis.push_back(twin);
  const auto system = build(description, {});
  ASSERT_FALSE(system.has_value());
  EXPECT_NE(system.error().message.find("'v' is already a state"), std::string::npos);
}

TEST(Hysteresis, TheBuilderStatesTheSame) {
  Builder builder("car");
  const auto v = builder.state("v", {12.0});
  const auto turbo = builder.hysteresis("turbo", v, {.on = 15.0, .off = 10.0, .initial = 1.0});
  builder.dynamics("v", 2.0 * (1.0 + 2.0 * turbo));
  const auto system = builder.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->initial_state, (std::vector<double>{12.0, 1.0}));
  EXPECT_EQ(system->jumps.front().name, "turbo");
  Builder wrong("car");
  const auto x = wrong.state("x", {0.0});
  static_cast<void>(wrong.hysteresis("h", x, {.on = 1.0, .off = 1.0}));
  wrong.dynamics("x", 1.0);
  EXPECT_FALSE(wrong.build().has_value());
}

TEST(Hysteresis, AStateMayBeCalledClock) {
  Builder builder("car");
  const auto v = builder.state("v", {12.0});
  builder.dynamics("clock", builder.state("clock", {0.0}));
  static_cast<void>(builder.hysteresis("turbo", v, {.on = 15.0, .off = 10.0}));
  builder.dynamics("v", 1.0);
  EXPECT_TRUE(builder.build().has_value());
}

/// Methods with events never ask for the frozen form, in which every expression may hold all hysteresis states.
TEST(Hysteresis, TheFrozenFormIsMadeWhenItIsAskedForAndOnce) {
  int made = 0;
  const FrozenSystem frozen([&]() -> Expected<System> {
    ++made;
    return System{};
  });
  EXPECT_EQ(made, 0);
  EXPECT_TRUE(frozen.system().has_value());
  EXPECT_TRUE(frozen.system().has_value());
  EXPECT_EQ(made, 1);
}

/// It is the form of what was stated when the system was built.
TEST(Hysteresis, TheFrozenFormKnowsNothingOfWhatIsAddedLater) {
  Builder builder("car");
  const auto v = builder.state("v", {12.0});
  static_cast<void>(builder.hysteresis("turbo", v, {.on = 15.0, .off = 10.0}));
  builder.dynamics("v", 1.0);
  const auto system = builder.build();
  ASSERT_TRUE(system.has_value());
  builder.dynamics("later", builder.state("later", {0.0}));
  ASSERT_TRUE(system->frozen->system().has_value());
  const auto& names = system->frozen->system()->state_names;
  EXPECT_EQ(std::count(names.begin(), names.end(), "later"), 0);
  EXPECT_TRUE(builder.build().has_value());
}

}  // namespace
}  // namespace saltus::model
