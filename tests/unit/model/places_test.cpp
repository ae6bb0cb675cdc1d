// Names of a system, and where their values are.
#include "saltus/model/places.hpp"

#include <gtest/gtest.h>

#include "built_system.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

TEST(Places, AreThoseOfTheVectors) {
  Builder model("cart");
  const SX m = model.parameter("m", 2.0), mu = model.parameter("mu", 0.5);
  const SX x = model.state("x", {1.0}), v = model.state("v", {3.0}), u = model.control("u", {4.0});
  model.dynamics("x", v);
  model.dynamics("v", u / m - mu * model.sign(v));
  const System system = finished(model);
  EXPECT_EQ(system.parameter_values[*parameter_place(system, "mu")], 0.5);
  EXPECT_EQ(system.initial_state[*state_place(system, "v")], 3.0);
  EXPECT_EQ(system.control_initial[*control_place(system, "u")], 4.0);
  const auto unknown = parameter_place(system, "nu");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::unknown_name);
  EXPECT_EQ(to_text(unknown.error()), "error: the system has no parameter 'nu'\n  known: m, mu");
  EXPECT_EQ(state_place(system, "mu").error().remedy, "known: x, v");
}

TEST(Places, OfWhatThereIsNoneOf) {
  Builder model("decay");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", -x);
  EXPECT_EQ(control_place(finished(model), "u").error().remedy, "it has no controls");
}

}  // namespace
}  // namespace saltus::model
