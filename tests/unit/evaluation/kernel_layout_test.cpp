// What a kernel adds to the layout of its system, and how both move with other values.
#include <gtest/gtest.h>

#include "saltus/evaluation/explanations.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
using model::greater;
using model::less;

/// Guards of all kinds: on a discrete state alone, together with an input that is a number, and on what moves.
model::System valves(double every) {
  model::Builder model("valves");
  model.parameter("k", 2.0);
  const SX x = model.state("x", {1.0}), u = model.control("u", {0.0});
  const SX first = model.discrete_state("first", 0.0), second = model.discrete_state("second", 1.0);
  model.dynamics("x", -x + model.step(second - 0.5));
  model.input("u", SX(3));
  model.event(x - 5);
  model.event(greater(x, SX(2)) && less(x, SX(4)));
  model.jump(greater(first, u), {{"second", 1 - second}}, {.name = "by_number"});
  model.jump(greater(x, first), {{"first", 1 - first}}, {.name = "by_state"});
  model.jump_every(every, {{"second", SX(0)}}, {.name = "tick"});
  auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : model::System{};
}

TEST(KernelLayout, GuardsAreNumberedAndKnownToBeDiscrete) {
  const auto kernel = ModelKernel::compile(valves(0.5));
  ASSERT_TRUE(kernel.has_value());
  const auto& layout = kernel->layout();
  const int n_psi = kernel->switching_functions();
  ASSERT_EQ(layout.events.size(), 2U);
  EXPECT_EQ(layout.events[1].guards[0].function, n_psi + 1);
  EXPECT_EQ(layout.events[1].guards[1].function, n_psi + 2);
  ASSERT_EQ(layout.jumps.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    const auto& guards = layout.jumps[static_cast<std::size_t>(k)].guards;
    for (std::size_t g = 0; g < guards.size(); ++g) {
      EXPECT_EQ(guards[g].function, kernel->jump_guard(k, static_cast<int>(g)));
      EXPECT_EQ(guards[g].discrete, kernel->is_discrete_guard(guards[g].function));
    }
  }
  EXPECT_TRUE(layout.jumps[0].guards[0].discrete);  // once its input is put in
  EXPECT_EQ(layout.jumps[0].guards[0].states, std::vector<int>{1});
  EXPECT_FALSE(layout.jumps[1].guards[0].discrete);
  EXPECT_TRUE(layout.jumps[1].guards[0].states.empty());
  ASSERT_EQ(layout.surfaces.size(), 1U);
  EXPECT_EQ(layout.surfaces[0].role, model::SwitchingRole::discrete);
  EXPECT_EQ(layout.surfaces[0].states, std::vector<int>{2});
}

TEST(KernelLayout, MovesWithTheValuesOfASystem) {
  auto kernel = ModelKernel::compile(valves(0.5));
  ASSERT_TRUE(kernel.has_value());
  auto second = ModelKernel::of(kernel->compiled(), NativeCode::off);
  ASSERT_TRUE(second.has_value());
  auto other = valves(0.25);
  other.initial_state = {7.0, 1.0, 0.0};
  ASSERT_TRUE(second->set_values(other));
  EXPECT_EQ(second->layout().jumps[2].every, 0.25);
  EXPECT_EQ(second->layout().jumps[0].guards[0].function, kernel->layout().jumps[0].guards[0].function);
  EXPECT_TRUE(second->layout().jumps[0].guards[0].discrete);
  EXPECT_EQ(second->layout().surfaces[0].states, std::vector<int>{2});
  EXPECT_EQ(second->initial_state(), other.initial_state);
  EXPECT_EQ(kernel->layout().jumps[2].every, 0.5);
  EXPECT_EQ(kernel->initial_state(), (std::vector<double>{1.0, 0.0, 1.0}));
}

TEST(KernelLayout, ExplanationsHaveTheValuesOfTheKernel) {
  model::Builder model("drag");
  const SX mu = model.parameter("mu", 0.5);
  const SX vx = model.state("vx", {3.0}), vy = model.state("vy", {4.0});
  const SX speed = sqrt(vx * vx + vy * vy);
  model.dynamics("vx", -mu * vx * speed);
  model.dynamics("vy", -mu * vy * speed);
  auto system = model.build();
  ASSERT_TRUE(system.has_value());
  const auto kernel = ModelKernel::compile(*system);
  ASSERT_TRUE(kernel.has_value());
  EXPECT_EQ(vanishing_norm(*kernel, 0.0, {3.0, 4.0}), "");
  EXPECT_NE(vanishing_norm(*kernel, 9.0, {3e-8, 4e-8}).find("a norm of vx, vy vanishes here"), std::string::npos);
  EXPECT_FALSE(find_indefinite_mass(*kernel, {3.0, 4.0}).has_value());
}

}  // namespace
}  // namespace saltus::evaluation
