// floor, mod, tables and sampled inputs in models: what they become, and what is refused.
#include <cmath>

#include <gtest/gtest.h>

#include "model_text.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

const std::vector<double> road_x{0, 1, 2, 3}, road_y{0, 0.5, 0.2, 0};

/// x, z with road(x): the right-hand side of z is stated.
Expected<System> with_road(const std::function<SX(Builder&, const SX&, const SX&, const SX&, const SX&)>& rate) {
  Builder model("road");
  const SX x = model.state("x", {0.5}), z = model.state("z", {0.25});
  const auto road = model.table("road", road_x, road_y);
  model.dynamics("x", 1);
  model.dynamics("z", rate(model, x, z, road(x), road(z)));
  return model.build();
}

/// f with the cells of their arguments at (t, x), alphas given.
std::vector<double> field(const System& system, double t, const std::vector<double>& x,
                          const std::vector<double>& alpha = {}) {
  SX symbols = SX(0, 1), arguments = SX(0, 1);
  std::vector<double> constants;
  for (const auto& cell : system.cells) {
    const casadi::Function f("f", {system.t, system.x, system.u, system.p, symbols}, {cell.argument});
    const auto argument = static_cast<double>(
        f(std::vector<casadi::DM>{t, x, system.control_initial, system.parameter_values, constants}).front());
    for (int column = 0; column < cell.table->columns; ++column) {
      constants.push_back(cell.table->constant(cell.table->cell(argument), column));
    }
    symbols = SX::vertcat({symbols, cell.symbols});
  }
  const casadi::Function f("f", {system.t, system.x, system.u, system.p, system.alpha, symbols}, {system.f});
  const auto result =
      f(std::vector<casadi::DM>{t, x, system.control_initial, system.parameter_values, alpha, constants});
  return std::vector<double>(result.front());
}

TEST(CellTerms, FloorAndModOfTime) {
  const auto system = built({.parameters = {{"T", "0.25"}},
                             .states = {{"x", "0"}, {"y", "0"}},
                             .dynamics = {{"x", "floor(t/T) + floor(t/T)"}, {"y", "mod(t, T) + mod(-t, 2)"}}});
  EXPECT_EQ(system.cells.size(), 2U);  // t/T is one argument, in floor and in mod
  EXPECT_EQ(system.cells[0].name, "floor(t/T)");
  for (const double t : {0.1, 0.6, 7.3, -0.1, -3.3}) {
    const auto f = field(system, t, {0, 0});
    EXPECT_DOUBLE_EQ(f[0], 2 * std::floor(t / 0.25));
    EXPECT_NEAR(f[1], t - 0.25 * std::floor(t / 0.25) + (-t - 2 * std::floor(-t / 2)), 1e-15) << t;
  }
}

TEST(CellTerms, ConstantsFold) {
  const auto system = built({.parameters = {{"p", "2.5"}, {"q", "floor(p)"}, {"r", "mod(-7, 3)"}},
                             .states = {{"x", "q"}},
                             .dynamics = {{"x", "floor(p/2) + mod(p, 1) + r"}}});
  EXPECT_TRUE(system.cells.empty());
  EXPECT_EQ(system.initial_state, (std::vector<double>{2}));
  EXPECT_DOUBLE_EQ(field(system, 0, {2})[0], 1 + 0.5 + 2);
}

TEST(CellTerms, AreRefusedForStatesAndWrongPeriods) {
  const auto x = [](const std::string& rate) {
    return refused(
        {.parameters = {{"p", "0"}}, .states = {{"x", "0"}}, .controls = {{"u", "0"}}, .dynamics = {{"x", rate}}});
  };
  for (const std::string text : {"floor(x)", "mod(x, 1)", "floor(t + sign(x))", "mod(u, 1)"}) {
    const auto error = x(text);
    EXPECT_EQ(error.code, ErrorCode::invalid_model) << text;
    EXPECT_NE(error.remedy.find("[[jumps]]"), std::string::npos) << text;
    EXPECT_EQ(error.location.line, 4) << text;
    EXPECT_EQ(error.location.column, 21) << text;
  }
  EXPECT_NE(x("mod(t, x)").message.find("constant other than 0"), std::string::npos);
  EXPECT_NE(x("mod(t, 0)").message.find("found 0"), std::string::npos);
  EXPECT_NE(x("mod(t, p)").message.find("found 0"), std::string::npos);
}

TEST(CellTerms, TablesInTheRightHandSide) {
  const auto system = with_road([](Builder&, const SX& x, const SX&, const SX& road_of_x, const SX& road_of_z) {
    return road_of_x * x - road_of_z;
  });
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->cells.size(), 2U);
  EXPECT_NEAR(field(*system, 0, {1.5, 2.5})[1], 0.35 * 1.5 - 0.1, 1e-15);
  EXPECT_NEAR(field(*system, 0, {-1.0, 5.0})[1], 0.0, 1e-15);
}

TEST(CellTerms, SwitchingFunctionsWithTablesAreSharedIfTheCellsAre) {
  const auto shared = with_road([](Builder& m, const SX&, const SX& z, const SX& road, const SX&) {
    return -m.sign(z - road) + m.step(2 * road - 2 * z);
  });
  ASSERT_TRUE(shared.has_value()) << to_text(shared.error());
  ASSERT_EQ(shared->switching.size(), 1U);
  EXPECT_EQ(shared->switching[0].role, SwitchingRole::listed);

  // Two tables that agree wherever points are drawn (|x| up to 100, mostly), and differ elsewhere.
  Builder model("two roads");
  const SX x = model.state("x", {0}), z = model.state("z", {0});
  const auto first = model.table("first", {0, 1, 5000, 6000}, {0, 1, 1, 2});
  const auto second = model.table("second", {0, 1, 5000, 6000}, {0, 1, 1, 3});
  model.dynamics("x", 1);
  model.dynamics("z", -model.sign(z - first(x)) - model.sign(z - second(x)));
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->switching.size(), 2U);
}

TEST(CellTerms, RolesOfSwitchingFunctions) {
  const auto role = [](const std::string& rate) {
    const auto system = built({.states = {{"x", "0"}}, .dynamics = {{"x", rate}}});
    EXPECT_EQ(system.switching.size(), 1U) << rate;
    return system.switching.at(0).role;
  };
  EXPECT_EQ(role("step(mod(t, 1) - 0.3)"), SwitchingRole::time_event);
  EXPECT_EQ(role("sign(mod(t, 1) - x)"), SwitchingRole::listed);
  EXPECT_EQ(role("max(mod(t, 1) - x, 0)"), SwitchingRole::kink);
  EXPECT_EQ(role("floor(t)*max(x, 0)"), SwitchingRole::kink);
  const auto kink =
      with_road([](Builder& m, const SX&, const SX& z, const SX& road, const SX&) { return m.abs(z - road); });
  EXPECT_EQ(kink.value().switching.at(0).role, SwitchingRole::kink);
}

TEST(CellTerms, ArgumentsAreTakenApartAtTheirKinks) {
  Builder model("abs inside");
  const SX x = model.state("x", {-1});
  const auto road = model.table("road", road_x, road_y);
  model.dynamics("x", road(model.abs(x)));
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->cells.size(), 2U);  // road(x) and road(-x)
  ASSERT_EQ(system->switching.size(), 1U);
  EXPECT_EQ(system->switching[0].role, SwitchingRole::kink);
  EXPECT_NEAR(field(*system, 0, {-1.5}, {0})[0], 0.35, 1e-15);
  EXPECT_NEAR(field(*system, 0, {1.5}, {1})[0], 0.35, 1e-15);
}

TEST(CellTerms, CellsInsideCells) {
  const auto system = built({.states = {{"x", "0"}}, .dynamics = {{"x", "floor(3*mod(t, 2))"}}});
  ASSERT_EQ(system.cells.size(), 2U);
  for (const double t : {0.1, 1.9, 2.1, 7.5}) {
    EXPECT_EQ(field(system, t, {0})[0], std::floor(3 * (t - 2 * std::floor(t / 2)))) << t;
  }
}

TEST(CellTerms, SampledInputs) {
  Builder model("sampled");
  const SX x = model.state("x", {0}), u = model.control("u", {9});
  model.dynamics("x", u - x);
  model.input("u", {0, 1, 2}, {4, 5, 6});
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  ASSERT_EQ(system->cells.size(), 1U);
  EXPECT_EQ(system->cells[0].name, "u");
  EXPECT_EQ(system->cells[0].table->breaks, (std::vector<double>{1, 2}));
}

TEST(CellTerms, BuilderRefusesBadTables) {
  const auto message = [](const std::function<void(Builder&)>& state) {
    Builder model("bad");
    static_cast<void>(model.state("x", {0}));
    state(model);
    const auto system = model.build();
    return system ? std::string() : system.error().message;
  };
  EXPECT_EQ(message([](Builder& m) {
              m.table("road", {0, 1, 1}, {0, 1, 2})(SX(1));
            }),
            "table 'road', point 3: the arguments must ascend, found 1 after 1");
  EXPECT_EQ(message([](Builder& m) {
              m.table("x", {0, 1}, {0, 1});
            }),
            "'x' is already a state and cannot be a table, too");
  EXPECT_EQ(message([](Builder& m) { m.table("sin", {0, 1}, {0, 1}); }), "'sin' is reserved and cannot name a table");
  EXPECT_EQ(message([](Builder& m) {
              static_cast<void>(m.control("u", {0}));
              m.input("u", {0, 1}, {0});
            }),
            "input 'u': 2 arguments, but 1 values");
}

}  // namespace
}  // namespace saltus::model
