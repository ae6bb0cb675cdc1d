// Kinks, time events, and which surfaces are listed.
#include "model_text.hpp"

namespace saltus::model {
namespace {

std::map<std::string, SwitchingRole> roles(const System& system) {
  std::map<std::string, SwitchingRole> result;
  for (const auto& function : system.switching) result[function.name] = function.role;
  return result;
}

TEST(Surfaces, ContinuousTermsAreKinks) {
  const System system =
      built({.states = {{"x", "1"}, {"y", "0"}},
             .dynamics = {{"x", "-3*max(x, 0) + abs(y - 0.3)"}, {"y", "min(x*y, 2*y) + max(x - y, 0.1)^2"}}});
  EXPECT_EQ(system.switching.size(), 4U);
  for (const auto& function : system.switching) EXPECT_EQ(function.role, SwitchingRole::kink) << function.name;
  EXPECT_TRUE(system.columns.empty());
  EXPECT_TRUE(system.inclusion_differences.empty());
}

TEST(Surfaces, AJumpAnywhereMakesASurfaceListed) {
  const System system = built({.states = {{"x", "1"}, {"y", "0"}, {"z", "0"}},
                               .dynamics = {{"x", "abs(x)"}, {"y", "max(y, 0) + 1e-3*step(y)"}, {"z", "1"}},
                               .outputs = {{"side", "sign(x)"}},
                               .events = {{"", "z - step(z - 1)"}}});
  EXPECT_EQ(roles(system),
            (std::map<std::string, SwitchingRole>{
                {"x", SwitchingRole::listed}, {"y", SwitchingRole::listed}, {"z-1", SwitchingRole::listed}}));
}

TEST(Surfaces, AnInnerSurfaceWithoutJumpIsAKink) {
  const System system = built({.states = {{"x", "0.5"}}, .dynamics = {{"x", "-sign(abs(x) - 1)"}}});
  EXPECT_EQ(roles(system),
            (std::map<std::string, SwitchingRole>{{"x", SwitchingRole::kink}, {"abs(x)-1", SwitchingRole::listed}}));
  EXPECT_EQ(columns(system), Names{"abs(x)-1"});
}

TEST(Surfaces, BranchesThatVanishAtTheStartAreNoJump) {
  // At x = 0, y = 1/2, t = 0 both branches are 0 but for roundings, which must not be compared with their own size.
  const System system = built({.states = {{"x", "0"}, {"y", "0.5"}},
                               .dynamics = {{"x",
                                             "-1.5 - 1.6*x + sign(y - 0.5 + max(0.5*x + y - 0.5 + "
                                             "0.5*sin(1.71399*t), y - 0.5))"},
                                            {"y", "1"}}});
  EXPECT_EQ(columns(system).size(), 1U);
  // However small the unit, a jump is one.
  const System small = built({.states = {{"x", "0"}}, .dynamics = {{"x", "1e-25*(x - sign(x))"}}});
  EXPECT_EQ(columns(small), Names{"x"});
}

TEST(Surfaces, AnInnerJumpIsListed) {
  const System system =
      built({.states = {{"x", "0.5"}, {"v", "0"}}, .dynamics = {{"x", "1"}, {"v", "-sign(v + step(x))"}}});
  EXPECT_EQ(columns(system), (Names{"x", "v+step(x)"}));
}

TEST(Surfaces, SuperTwistingIsNotHiddenByItsRoot) {
  // The slope of sqrt(abs(x)) is infinite at 0: it must neither pass for a jump nor hide the one of the sign.
  const System smooth = built({.states = {{"x", "1"}}, .dynamics = {{"x", "-sqrt(abs(x - 0.3))*sign(x - 0.3)"}}});
  EXPECT_EQ(smooth.switching[0].role, SwitchingRole::kink);
  const System jumping =
      built({.states = {{"x", "1"}}, .dynamics = {{"x", "-sqrt(abs(x - 0.3)) - 0.1*sign(x - 0.3)"}}});
  EXPECT_EQ(jumping.switching[0].role, SwitchingRole::listed);
}

TEST(Surfaces, AJumpInAThinRegionIsFound) {
  const System system = built({.states = {{"x", "1"}, {"v", "0"}},
                               .dynamics = {{"x", "if(v > 0.5 and v < 0.501 and x > 2, 1, 0)"}, {"v", "abs(x - 3)"}}});
  EXPECT_EQ(columns(system), (Names{"v-0.5", "0.501-v", "x-2"}));
}

TEST(Surfaces, AJumpThatNeedsManyConditionsIsFound) {
  std::string condition;
  Table states, dynamics;
  for (int i = 0; i < 12; ++i) {
    const std::string name = "x" + std::to_string(i);
    states.push_back({name, "0"});
    dynamics.push_back({name, "0"});
    condition +=
        (i > 0 ? " and " : "") + name + " > " + std::to_string(i - 6) + "*x" + std::to_string((i + 1) % 12) + " + 2";
  }
  dynamics[0].second = "if(" + condition + ", 1, -1)";
  EXPECT_EQ(built({.states = states, .dynamics = dynamics}).columns.size(), 12U);
}

TEST(Surfaces, AConditionThatCannotHoldOnASurfaceMakesNoJumpThere) {
  const System system =
      built({.states = {{"x", "1"}, {"y", "0"}}, .dynamics = {{"x", "if(x > 0, if(x > 5, 3, 1), 1)"}, {"y", "0"}}});
  EXPECT_EQ(columns(system), Names{"x-5"});
}

TEST(Surfaces, SmallJumpsBesideLargeTermsAreFound) {
  const System system = built({.states = {{"x", "1"}}, .dynamics = {{"x", "1e6*x + 1e-3*sign(x - 7)"}}});
  EXPECT_EQ(system.switching[0].role, SwitchingRole::listed);
}

// Charges in Coulomb, molecules in mol: what is small is for the model to say.
TEST(Surfaces, JumpsOfModelsInSmallUnitsAreFound) {
  for (const std::string jump : {"1e-15", "1e-19", "1e-25", "1e-30"}) {
    const ModelText text{.states = {{"x", "1e-20"}, {"y", "0"}},
                         .dynamics = {{"x", "-abs(x) - " + jump + "*sign(x)"}, {"y", "-x - " + jump + "*sign(y)"}}};
    const System system = built(text);
    EXPECT_EQ(columns(system), (Names{"x", "y"})) << jump;
  }
  const System kinks = built({.states = {{"x", "1e-20"}, {"y", "0"}},
                              .dynamics = {{"x", "abs(x - 0.3) + max(x, y)"}, {"y", "1e-20*abs(abs(y) - 1) + 0.1"}}});
  EXPECT_EQ(columns(kinks), Names{});
}

TEST(Surfaces, ASurfaceThatNeverIsReachedIsListed) {
  EXPECT_EQ(columns(built({.states = {{"x", "1"}}, .dynamics = {{"x", "sign(x^2 + 1)"}}})), Names{"x^2+1"});
  EXPECT_EQ(columns(built({.states = {{"x", "1"}}, .dynamics = {{"x", "sign(x^2)"}}})), Names{"x^2"});
}

TEST(Surfaces, FunctionsOfTimeAreTimeEvents) {
  const System system = built({.states = {{"x", "1"}},
                               .controls = {{"u", "0"}},
                               .switching = {{"late", "t - 2"}},
                               .dynamics = {{"x", "step(sin(3*t)) + step(late) + u + step(x - step(t - 1))"}},
                               .inputs = {{"u", "step(t - 5)"}}});
  EXPECT_EQ(roles(system), (std::map<std::string, SwitchingRole>{{"late", SwitchingRole::time_event},
                                                                 {"sin(3*t)", SwitchingRole::time_event},
                                                                 {"t-1", SwitchingRole::time_event},
                                                                 {"x-step(t-1)", SwitchingRole::listed},
                                                                 {"t-5", SwitchingRole::time_event}}));
  EXPECT_EQ(columns(system), (Names{"late", "x-step(t-1)"}));
}

TEST(Surfaces, NamedKinksKeepTheirColumn) {
  const System system = built({.states = {{"x", "1"}, {"y", "1"}},
                               .switching = {{"side", "x"}, {"idle", "y - 4"}},
                               .dynamics = {{"x", "abs(side)"}, {"y", "1"}}});
  EXPECT_EQ(columns(system), (Names{"side", "idle"}));
  EXPECT_EQ(system.switching[0].role, SwitchingRole::kink);
  EXPECT_EQ(system.switching[1].role, SwitchingRole::kink);
  EXPECT_EQ(system.warnings, Names{"model.toml:4: switching function 'idle' is never used"});
}

TEST(Surfaces, ThresholdsOfIrma) {
  const System system =
      built({.parameters = {{"u", "1"}},
             .states = {{"x1", "0.011"}, {"x2", "0.09"}, {"x3", "0.04"}, {"x4", "0.05"}, {"x5", "0.015"}},
             .dynamics = {{"x1", "-0.05*x1 + 1.1e-4 + 9e-4*step(x5 - 0.01)"},
                          {"x2", "-0.04*x2 + 3e-4 + 0.15*step(x1 - 0.01)*(1 - (1 - u)*step(x5 - 0.01))"},
                          {"x3", "-0.05*x3 + 6e-4 + 0.018*step(x2 - 0.06)"},
                          {"x4", "-0.02*x4 + 5e-4*step(x2 - 0.01) + 0.03*step(x2 - 0.01)*(1 - step(x3 - 0.035))"},
                          {"x5", "-0.6*x5 + 7.5e-4 + 0.015*step(x2 - 0.08) + 1e-5*step(x4 - 0.04)"}}});
  EXPECT_EQ(columns(system), (Names{"x5-0.01", "x1-0.01", "x2-0.06", "x2-0.01", "x3-0.035", "x2-0.08", "x4-0.04"}));
  EXPECT_TRUE(system.multi_affine);
}

TEST(Surfaces, AJumpBesideAKinkOfOneFunctionAroundASignIsListed) {
  const System system =
      built({.states = {{"x", "0.2"}, {"y", "0"}},
             .dynamics = {{"x", "max(y + x + 0.15*sign(x), -1)"}, {"y", "if(y + x + 0.15*sign(x) < -1, 0, x)"}}});
  ASSERT_EQ(system.switching.size(), 2U);
  for (const auto& function : system.switching) EXPECT_EQ(function.role, SwitchingRole::listed) << function.name;
}

}  // namespace
}  // namespace saltus::model
