// Forces of many contacts are numbers: the same ones, and the same derivatives, as from an elimination.
#include <cmath>

#include <gtest/gtest.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/model/mechanics/contact.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
using model::Activity;

constexpr int touching = 3;

/// Two discs on a curved floor lean on each other; walls that are far away make the contacts many.
ModelKernel discs(int walls) {
  model::Builder model("discs");
  std::vector<SX> q;
  q.push_back(model.state("x1", {.initial = 0.3}));
  q.push_back(model.state("y1", {.initial = 0.05}));
  q.push_back(model.state("x2", {.initial = 1.3}));
  q.push_back(model.state("y2", {.initial = 0.4}));
  for (const std::string name : {"u1", "w1", "u2", "w2"}) static_cast<void>(model.state(name, {}));
  const SX t = model.time();
  model.mechanics({.positions = {"x1", "y1", "x2", "y2"},
                   .velocities = {"u1", "w1", "u2", "w2"},
                   .mass = SX::diag(SX::vertcat({2.0, 2.0, 3.0, 3.0})),
                   .force = {{"u1", SX::sin(3.0 * t) - q[0] * q[0]}, {"w1", -19.62}, {"u2", -q[2]}, {"w2", -29.43}}});
  const auto floor = [](const SX& x) { return 0.1 * x * x; };
  model.contact("left", q[1] - floor(q[0]), {.tangent = {{"x1", 1.0}}, .friction = 0.4});
  model.contact("right", q[3] - floor(q[2]), {.tangent = {{"x2", 1.0}}, .friction = 0.3});
  const SX dx = q[2] - q[0], dy = q[3] - q[1];
  model.contact("between", SX::sqrt(dx * dx + dy * dy) - 1.0,
                {.tangent = {{"y1", 1.0}, {"y2", -1.0}}, .friction = 0.2});
  for (int k = 0; k < walls; ++k) {
    model.contact("wall" + std::to_string(k), q[0] + 50.0 + k, {.tangent = {{"y1", 1.0}}, .friction = 0.5});
  }
  auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  auto kernel = ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  kernel->set_activity(0, {.state = Activity::State::stick, .carries = true, .holds = {true, false}});
  kernel->set_activity(1, {.state = Activity::State::slip, .carries = true, .share = {1.0, 0.0}});
  kernel->set_activity(2, {.state = Activity::State::slip, .carries = true, .share = {-1.0, 0.0}});
  return std::move(*kernel);
}

TEST(ContactSolve, GivesTheForcesAndDerivativesOfTheElimination) {
  const ModelKernel few = discs(0), many = discs(10);
  const int guards = few.event_functions() / touching;
  ASSERT_GE(many.event_functions(), (touching + 10) * guards);
  const std::vector<double> x{0.3, 0.05, 1.2, 0.4, 0.1, -0.2, 0.4, 0.3};
  const double t = 0.7;
  std::vector<double> a(8), b(8);
  few.field(t, x.data(), nullptr, a.data());
  many.field(t, x.data(), nullptr, b.data());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << i;
  int differing = 0;
  for (int function = 0; function < touching * guards; ++function) {
    double rate_a = 0.0, rate_b = 0.0;
    few.gradient(function, t, x.data(), nullptr, a.data(), &rate_a);
    many.gradient(function, t, x.data(), nullptr, b.data(), &rate_b);
    EXPECT_NEAR(rate_a, rate_b, 1e-10 * (1.0 + std::abs(rate_a))) << function;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-10 * (1.0 + std::abs(a[i]))) << function;
    for (const auto& [order, allowed] : {std::pair{1, 1e-10}, {2, 1e-6}, {3, 1e-4}}) {
      const double exact = few.lie_derivative(function, order, t, x.data(), nullptr);
      const double size = 1.0 + std::abs(exact);
      EXPECT_NEAR(many.lie_derivative(function, order, t, x.data(), nullptr), exact, allowed * size)
          << function << ", order " << order;
      differing += exact != 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(differing, 3);
}

}  // namespace
}  // namespace saltus::evaluation
