#include "saltus/model/structure.hpp"

#include <string>

#include <gtest/gtest.h>

#include "saltus/model/build.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

/// x' = a x - sign(x - b) and what `more` adds to it.
System with_coefficients(double a, double b, const SX& factor = 1.0) {
  Builder model("m");
  const SX pa = model.parameter("a", a), pb = model.parameter("b", b), x = model.state("x", {1.0});
  model.dynamics("x", factor * pa * x - model.sign(x - pb));
  return model.build().value();
}

TEST(Structure, IsTheSameForOtherParametersAndInitialValues) {
  EXPECT_EQ(structure(with_coefficients(1.0, 2.0)), structure(with_coefficients(3.0, -4.0)));
  System other = with_coefficients(1.0, 2.0);
  other.initial_state[0] = 7.0;
  EXPECT_EQ(structure(with_coefficients(1.0, 2.0)), structure(other));
}

TEST(Structure, HasEveryOperationAndConstant) {
  EXPECT_NE(structure(with_coefficients(1.0, 2.0)), structure(with_coefficients(1.0, 2.0, 2.0)));
  EXPECT_NE(structure(with_coefficients(1.0, 2.0, 3.0)), structure(with_coefficients(1.0, 2.0, 2.0)));
}

TEST(Structure, TellsSharedExpressionsFromEqualOnes) {
  const auto with = [](bool shared) {
    Builder model("m");
    const SX x = model.state("x", {1.0});
    const SX first = sin(x), second = shared ? first : sin(x);
    model.dynamics("x", first * exp(second));
    return model.build().value();
  };
  EXPECT_NE(structure(with(true)), structure(with(false)));
}

TEST(Structure, DoesNotRecurse) {
  Builder model("m");
  const SX x = model.state("x", {1.0});
  SX sum = x;
  for (int i = 0; i < 20000; ++i) sum = sin(sum) + x;
  model.dynamics("x", x);
  auto system = model.build().value();
  system.f = sum;
  EXPECT_GT(structure(system).size(), 40000U);
}

}  // namespace
}  // namespace saltus::model
