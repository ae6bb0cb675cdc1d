// Small models for the tests of the FESD problem, and their kernels.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/discretization/fesd_problem.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::discretization {

using casadi::SX;
using reformulation::Form;

/// x' = a - b sign(x) + c t + d sin(5 t).
inline model::System scalar_model(double a, double b, double c = 0.0, double d = 0.0) {
  model::Builder builder("scalar");
  const SX x = builder.state("x", {});
  const SX t = builder.time();
  SX rate = a - b * builder.sign(x);
  if (c != 0.0) rate += c * t;
  if (d != 0.0) rate += d * SX::sin(5.0 * t);
  builder.dynamics("x", rate);
  return *builder.build();
}

/// The rotating oscillator (problem 3): A_1 x inside of the unit circle, A_2 x outside, rotation of 2 pi per unit of
/// time.
inline model::System rotating_oscillator() {
  const double omega = 2.0 * std::acos(-1.0);
  model::Builder builder("oscillator");
  const SX x = builder.state("x", {});
  const SX y = builder.state("y", {});
  const SX rotation = omega * (1.0 - 2.0 * builder.step(x * x + y * y - 1.0));
  builder.dynamics("x", x - rotation * y);
  builder.dynamics("y", rotation * x + y);
  return *builder.build();
}

/// The state slides along the unit circle with angular velocity (1 + r v) / r, r = 1: the tangential speed is 1, the
/// radial one drives to the circle from both sides.
inline model::System circle() {
  model::Builder builder("circle");
  const SX x = builder.state("x", {});
  const SX y = builder.state("y", {});
  const SX s = builder.sign(x * x + y * y - 1.0);
  builder.dynamics("x", -y - 0.5 * s * x + 0.2 * x * y);
  builder.dynamics("y", x - 0.5 * s * y + 0.1 * x);
  return *builder.build();
}

/// Two surfaces with a product of their selections, a curved one, time, and a parameter: every term of the kernel.
inline model::System everything() {
  model::Builder builder("everything");
  const SX p = builder.parameter("p", 0.7);
  const SX x = builder.state("x", {});
  const SX y = builder.state("y", {});
  const SX a = builder.step(x - 0.3 * y * y);
  const SX b = builder.step(y + 0.1 * x);
  const SX c = builder.step(x + y - 1.0);
  builder.dynamics("x", a * b * c * y - p * a + SX::sin(builder.time()));
  builder.dynamics("y", 1.0 - 2.0 * b + x * a);
  return *builder.build();
}

inline reformulation::Dcs dcs_of(const model::System& system, Form form) {
  auto dcs = reformulation::reformulate(system, {.reformulation = form, .lifting = 2});
  EXPECT_TRUE(dcs.has_value()) << (dcs ? "" : to_text(dcs.error()));
  return *dcs;
}

struct Scheme {
  TableauFamily family = TableauFamily::radau_iia;
  int stages = 2;
  FesdOptions options;
};

inline std::shared_ptr<FesdKernel> kernel_of(const model::System& system, Form form, const Scheme& scheme) {
  const auto tableau = butcher_tableau(scheme.family, scheme.stages);
  auto kernel = FesdKernel::compile(dcs_of(system, form), system.parameter_values, *tableau, scheme.options);
  EXPECT_TRUE(kernel.has_value()) << (kernel ? "" : to_text(kernel.error()));
  return *kernel;
}

}  // namespace saltus::discretization
