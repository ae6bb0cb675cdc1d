// Steps of a part of a large system: the events of the steps of all of it, at a part of the evaluations.
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::Termination;

/// x_i' = sum of three k step(+-(x_j - threshold)) - x_i + coupling (x_(i-1) + x_(i+1) - 2 x_i), at random.
struct Network {
  int genes = 0;
  double coupling = 0.0;
  unsigned seed = 1;
};

Integration run(const Network& network, const IntegrationOptions& options) {
  std::mt19937 random(network.seed);
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 0x1p32;
  };
  Builder b("network");
  std::vector<SX> x;
  for (int i = 0; i < network.genes; ++i) x.push_back(b.state("x" + std::to_string(i), {number(0.0, 1.0)}));
  for (std::size_t i = 0; i < x.size(); ++i) {
    SX rate = -x[i];
    for (int k = 0; k < 3; ++k) {
      // A gene that acts on itself may slide on its threshold: such modes take steps of all states.
      const std::size_t from = (i + 1 + random() % (x.size() - 1)) % x.size();
      const double threshold = number(0.2, 0.8);
      const SX psi = random() % 2 == 0 ? x[from] - threshold : threshold - x[from];
      rate += number(0.2, 0.5) * b.step(b.switching("s" + std::to_string(i) + "_" + std::to_string(k), psi));
    }
    if (network.coupling > 0.0 && i > 0) rate += network.coupling * (x[i - 1] - x[i]);
    if (network.coupling > 0.0 && i + 1 < x.size()) rate += network.coupling * (x[i + 1] - x[i]);
    b.dynamics("x" + std::to_string(i), rate);
  }
  return testing::run_model(b, options);
}

IntegrationOptions with(ode::Method method, double rtol, bool local) {
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {rtol, 1e-2 * rtol};
  options.until = 6.0;
  options.local_steps = local;
  return options;
}

void expect_same(const Integration& found, const Integration& expected, double accuracy) {
  ASSERT_EQ(found.status.termination, Termination::completed) << found.status.message;
  ASSERT_EQ(expected.status.termination, Termination::completed) << expected.status.message;
  ASSERT_EQ(found.events.size(), expected.events.size());
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    EXPECT_EQ(found.events[i].surfaces, expected.events[i].surfaces) << i;
    EXPECT_NEAR(found.events[i].t, expected.events[i].t, accuracy) << i;
  }
  ASSERT_EQ(found.final.x.size(), expected.final.x.size());
  for (std::size_t i = 0; i < found.final.x.size(); ++i) {
    EXPECT_NEAR(found.final.x[i], expected.final.x[i], accuracy) << i;
  }
}

TEST(LocalSteps, OfANetworkHaveTheEventsOfAllItsSteps) {
  for (const ode::Method method : {ode::Method::dopri5, ode::Method::dop853}) {
    const Network network{200, 0.0, 7};
    const auto exact = run(network, with(ode::Method::dop853, 1e-12, false));
    EXPECT_GT(exact.events.size(), 300U);
    const auto all = run(network, with(method, 1e-8, false));
    const auto local = run(network, with(method, 1e-8, true));
    expect_same(local, exact, 1e-7);
    EXPECT_LT(local.statistics.rhs_evaluations, all.statistics.rhs_evaluations / 2);
  }
}

TEST(LocalSteps, CoupledStatesFeelWhatTheToleranceLetsThem) {
  for (const double rtol : {1e-5, 1e-8, 1e-10}) {
    // Two of its genes switch each other 445 times, faster and faster, which makes errors ten times larger than others.
    const Network network{120, 0.5, 3};
    const auto exact = run(network, with(ode::Method::dop853, 1e-13, false));
    expect_same(run(network, with(ode::Method::dopri5, rtol, true)), exact, 60.0 * rtol);
    const Network calm{120, 0.5, 4};
    expect_same(run(calm, with(ode::Method::dopri5, rtol, true)), run(calm, with(ode::Method::dop853, 1e-13, false)),
                10.0 * rtol);
  }
}

TEST(LocalSteps, SmallerTolerancesGiveSmallerErrors) {
  const Network network{100, 0.2, 5};
  const auto exact = run(network, with(ode::Method::dop853, 1e-13, false));
  double errors[2];
  for (const int k : {0, 1}) {
    const auto found = run(network, with(ode::Method::dopri5, k == 0 ? 1e-5 : 1e-8, true));
    ASSERT_EQ(found.events.size(), exact.events.size());
    errors[k] = 0.0;
    for (std::size_t i = 0; i < found.events.size(); ++i) {
      errors[k] = std::max(errors[k], std::abs(found.events[i].t - exact.events[i].t));
    }
  }
  EXPECT_LT(errors[1], errors[0] / 30.0);
}

/// Blocks on springs, q_i'' = q_(i-1) - 2.5 q_i + q_(i+1) - 0.1 q_i' + 1.5 sin(0.9 t + i) - sign(q_i' - 0.2): they
/// stick and slip. With `tilt` the surfaces are those of q_i' + tilt q_i, so that what is slid on is no state.
Integration run_blocks(int blocks, double tilt, const IntegrationOptions& options) {
  Builder b("blocks");
  std::vector<SX> q, v;
  for (int i = 1; i <= blocks; ++i) {
    q.push_back(b.state("q" + std::to_string(i), {std::sin(1.7 * i)}));
    v.push_back(b.state("v" + std::to_string(i), {0.5 * std::cos(2.3 * i)}));
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    const SX friction = 2 * b.step(b.switching("s" + number, v[i] + tilt * q[i] - 0.2)) - 1;
    SX force = -2.5 * q[i] - 0.1 * v[i] + 1.5 * SX::sin(0.9 * b.time() + static_cast<double>(i)) - friction;
    if (i > 0) force += q[i - 1];
    if (i + 1 < q.size()) force += q[i + 1];
    b.dynamics("q" + number, v[i]);
    b.dynamics("v" + number, force);
  }
  return testing::run_model(b, options);
}

TEST(LocalSteps, OfBlocksThatStickHaveTheEventsOfAllTheirSteps) {
  for (const double tilt : {0.0, 0.1}) {
    const auto run = [&](ode::Method method, double rtol, bool local) {
      auto options = with(method, rtol, local);
      options.until = 12.0;
      return run_blocks(100, tilt, options);
    };
    const auto exact = run(ode::Method::dop853, 1e-12, false);
    int left = 0;
    for (const auto& event : exact.events) left += event.kind == result::EventKind::leave_sliding ? 1 : 0;
    EXPECT_GT(left, 30);
    const auto all = run(ode::Method::dop853, 1e-8, false), local = run(ode::Method::dop853, 1e-8, true);
    expect_same(local, exact, 2e-7);
    EXPECT_LT(local.statistics.rhs_evaluations, all.statistics.rhs_evaluations / 2);
    expect_same(run(ode::Method::dopri5, 1e-8, true), exact, 2e-7);
  }
}

/// z_i switches what drives u_i, and w_i follows its integral s_i by sliding on w_i + w_i^3 = s_i.
Integration run_followers(int units, const IntegrationOptions& options) {
  Builder b("followers");
  for (int i = 0; i < units; ++i) {
    const std::string number = std::to_string(i);
    const SX z = b.state("z" + number, {std::sin(1.7 * i)}), u = b.state("u" + number, {0.0}),
             s = b.state("s" + number, {0.1}), w = b.state("w" + number, {0.0});
    b.dynamics("z" + number, SX::cos(1.3 * b.time() + i));
    b.dynamics("u" + number, SX::cos(b.time() + 2 * i) + b.step(b.switching("switch" + number, z - 0.3)) - u);
    b.dynamics("s" + number, u);
    b.dynamics("w" + number, 3 - 6 * b.step(b.switching("follow" + number, w + w * w * w - s)));
  }
  return testing::run_model(b, options);
}

TEST(LocalSteps, WhatSlidesOnASurfaceThatIsNotAffineFollowsASwitch) {
  const auto exact = run_followers(40, with(ode::Method::dop853, 1e-12, false));
  EXPECT_GT(exact.events.size(), 80U);
  expect_same(run_followers(40, with(ode::Method::dopri5, 1e-8, true)), exact, 2e-7);
}

/// z = t switches one u_i after the other, while w' = cos(t) - 2 sign(w) from -0.1 comes to slide on 0, and y' =
/// sign(w).
TEST(LocalSteps, WhatSlidesBehindCrossingsHasTheFieldsOfBothSides) {
  constexpr double end = 0.6;
  Builder b("behind crossings");
  const SX z = b.state("z", {0.0}), w = b.state("w", {-0.1});
  b.state("y", {0.0});
  const SX sign = 2 * b.step(b.switching("speed", w)) - 1;
  b.dynamics("z", 1.0);
  b.dynamics("w", SX::cos(b.time()) - 2 * sign);
  b.dynamics("y", sign);
  for (int i = 0; i < 68; ++i) {
    const std::string number = std::to_string(i);
    const SX u = b.state("u" + number, {0.0});
    b.dynamics("u" + number, b.step(b.switching("s" + number, z - 0.01 * (i + 1))) - u);
  }
  auto options = with(ode::Method::dopri5, 1e-8, true);
  options.until = end;
  const auto run = testing::run_model(b, options);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  double reached = 0.03;  // sin(t) + 2 t = 0.1
  for (int k = 0; k < 20; ++k) reached -= (std::sin(reached) + 2 * reached - 0.1) / (std::cos(reached) + 2);
  EXPECT_EQ(run.final.x[1], 0.0);
  EXPECT_NEAR(run.final.x[2], -reached + 0.5 * (std::sin(end) - std::sin(reached)), 1e-9);
}

TEST(LocalSteps, SmallSystemsHaveTheSameBitsWithAndWithout) {
  const Network network{30, 0.3, 2};
  const auto all = run(network, with(ode::Method::dopri5, 1e-8, false));
  const auto local = run(network, with(ode::Method::dopri5, 1e-8, true));
  EXPECT_EQ(local.final.x, all.final.x);
}

}  // namespace
}  // namespace saltus::event_integrator
