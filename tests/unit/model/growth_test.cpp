// What it costs to build a model grows with its size: counted in nodes that are walked, not in seconds.
#include <fmt/format.h>

#include "model_text.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/model/graph/tape_internal.hpp"
#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {
namespace {

/// x_i' = sum_j w_ij term(x_j) - 9 x_i: n^2 terms.
Description network(int n, const std::string& term) {
  Description description;
  for (int i = 0; i < n; ++i) {
    std::string rate = fmt::format("-9*x{}", i);
    for (int j = 0; j < n; ++j) {
      rate += fmt::format("+{}*{}", 1.0 + 0.01 * ((7 * i + 3 * j) % 11),
                          fmt::format(fmt::runtime(term), fmt::format("x{}-0.5", j)));
    }
    const std::string name = fmt::format("x{}", i);
    description.states.push_back({name, expression::number(1.0, {}), nullptr, nullptr, {}});
    description.dynamics.push_back({name, parsed(rate, {}), {}});
  }
  return description;
}

/// n masses in a row with springs.
Description springs(int n, bool coupled_masses) {
  Description description;
  MechanicsDescription mechanics;
  const auto name = [](const char* kind, int i) { return fmt::format("{}{}", kind, i); };
  for (const char* kind : {"q", "v"}) {
    for (int i = 0; i < n; ++i) {
      description.states.push_back({name(kind, i), expression::number(0.1 * i, {}), nullptr, nullptr, {}});
    }
  }
  for (int i = 0; i < n; ++i) {
    mechanics.positions.push_back({name("q", i), {}});
    mechanics.velocities.push_back({name("v", i), {}});
    std::vector<expression::NodePtr> row;
    for (int j = 0; j < n; ++j) {
      const double beside = coupled_masses && std::abs(i - j) == 1 ? 1.0 : 0.0;
      row.push_back(expression::number(i == j ? 4.0 : beside, {}));
    }
    mechanics.mass.push_back(row);
    std::string force = fmt::format("-2*q{}", i);
    if (i > 0) force += fmt::format("+q{}", i - 1);
    if (i + 1 < n) force += fmt::format("+q{}", i + 1);
    mechanics.force.push_back({name("v", i), parsed(force, {}), {}});
  }
  description.mechanics = mechanics;
  return description;
}

Description thermostats(int n) {
  Description description;
  for (int i = 0; i < n; ++i) {
    const std::string name = fmt::format("T{}", i);
    description.states.push_back({name, expression::number(19.0 + 0.001 * i, {}), nullptr, nullptr, {}});
    description.dynamics.push_back({name, parsed(fmt::format("-0.1*(T{0}-10)+2*h{0}", i), {}), {}});
    HysteresisDescription heats;
    heats.name = fmt::format("h{}", i);
    heats.input = parsed("-" + name, {});
    heats.on = parsed("-18", {});
    heats.off = parsed("-20", {});
    description.hysteresis.push_back(heats);
  }
  return description;
}

/// Nodes that were walked in building it.
double cost(const Description& description) {
  const std::size_t before = Tape::walked();
  const auto system = build(description, {});
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return static_cast<double>(Tape::walked() - before);
}

TEST(Growth, ANetworkCostsWhatItsTermsDo) {
  for (const std::string term : {"step({})", "max({}, 0)", "abs({})", "tanh(max({}, 0.1))"}) {
    const double small = cost(network(20, term)), large = cost(network(80, term));
    EXPECT_LT(large, 1.25 * 16.0 * small) << term;  // 16 times the terms
  }
}

TEST(Growth, AKinkInADenseNetworkStaysOne) {
  for (const auto& [term, role] : {std::pair{"step({})", SwitchingRole::listed},
                                   {"max({}, 0)", SwitchingRole::kink},
                                   {"(max({0}, 0)+1e-4*step({0}))", SwitchingRole::listed},
                                   {"({0})*sign({0})", SwitchingRole::kink}}) {
    const auto system = build(network(20, term), {});
    ASSERT_TRUE(system.has_value());
    ASSERT_EQ(system->switching.size(), 20U) << term;
    for (const auto& function : system->switching) EXPECT_EQ(function.role, role) << term << ": " << function.name;
  }
}

TEST(Growth, MechanicsCostsWhatItsBandDoes) {
  for (const bool coupled : {false, true}) {
    const double small = cost(springs(20, coupled)), large = cost(springs(80, coupled));
    // Of factors each acceleration is an expression of all forces, which as many checks walk.
    EXPECT_LT(large, (coupled ? 1.25 * 16.0 : 1.25 * 4.0) * small) << coupled;
  }
}

TEST(Growth, FactorsOfABandStayInIt) {
  const auto entries_of = [](casadi_int n) {
    casadi::SX m = 4.0 * casadi::SX::eye(n);
    for (casadi_int i = 0; i + 1 < n; ++i) m(i, i + 1) = m(i + 1, i) = 1.0;
    return SymbolicLdl(m, casadi::SX::sym("q")).entries_below();
  };
  EXPECT_EQ(entries_of(10), 9U);
  EXPECT_EQ(entries_of(1000), 999U);
}

TEST(Growth, HysteresisIsLinear) {
  const double small = cost(thermostats(50)), large = cost(thermostats(200));
  EXPECT_LT(large, 1.25 * 4.0 * small);
}

TEST(Growth, WhatIsPreparedIsToldAndCanBeStopped) {
  const auto description = network(150, "step({})");
  std::vector<std::string> phases;
  {
    const PreparationScope scope([&](const Preparation& now) {
      if (phases.empty() || phases.back() != now.phase) phases.emplace_back(now.phase);
      return true;
    });
    EXPECT_TRUE(build(description, {}).has_value());
  }
  ASSERT_FALSE(phases.empty());
  EXPECT_EQ(phases.front(), "reading the model");
  const PreparationScope scope([](const Preparation&) { return false; });
  EXPECT_THROW(
      while (true) { static_cast<void>(build(description, {})); }, Stopped);
}

}  // namespace
}  // namespace saltus::model
