// The fast path of the usual event against the full decision, and what an event costs.
#include "saltus/event_integrator/decide/fast/single_surface.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "same_transition.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

/// Two affine fields that meet at an affine surface in three dimensions, all coefficients random.
model::System random_fields(std::mt19937& random, bool with_tangent_field) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  auto s = testing::blank(3, 1);
  SX psi = number(random) * s.t;
  for (int i = 0; i < 3; ++i) psi += number(random) * s.x(i);
  testing::add_surface(s, "s", psi);
  std::vector<SX> f;
  for (int i = 0; i < 3; ++i) {
    SX sides[2];
    for (auto& side : sides) {
      side = number(random);
      for (int k = 0; k < 3; ++k) side += number(random) * s.x(k);
    }
    f.push_back((1 - s.alpha(0)) * sides[0] + s.alpha(0) * sides[1]);
  }
  if (with_tangent_field) {
    // The upper field loses its normal component at the point (0, 0, 0), t = 0, where its derivative stays.
    const SX gradient = SX::jacobian(psi, s.x);
    const SX normal = SX::mtimes(gradient, SX::vertcat(f)) + SX::jacobian(psi, s.t);
    const SX upper = SX::substitute(SX::substitute(normal, s.alpha, SX(1)), SX::vertcat({s.t, s.x}), SX::zeros(4, 1));
    for (int i = 0; i < 3; ++i)
      f[static_cast<std::size_t>(i)] -= s.alpha(0) * gradient(i) * upper / dot(gradient, gradient);
  }
  testing::set_field(s, f, {0.0, 0.0, 0.0});
  return s;
}

SwitchingPoint at_origin(const std::vector<double>& origin) {
  SwitchingPoint switching_point;
  switching_point.x = origin.data();
  switching_point.at_zero = {0};
  switching_point.touched = {0};
  switching_point.time_scale = 0.1;
  return switching_point;
}

TEST(SingleSurface, DecidesCrossingsAndEntriesLikeTheGeneralDecision) {
  std::mt19937 random(20240611);
  const std::vector<double> origin(3, 0.0);
  int crossings = 0;
  int entries = 0;
  int left = 0;
  for (int k = 0; k < 60; ++k) {
    const auto system = random_fields(random, false);
    auto kernel = evaluation::ModelKernel::compile(system);
    ASSERT_TRUE(kernel.has_value());
    const SwitchingContext switching_context{*kernel, true, {}, {}};
    SingleSurface single(switching_context);
    Transition transition;
    for (const int side : {-1, 1}) {
      const ModeState before{{side}, {side > 0 ? 1.0 : 0.0}, {}, {}};
      const auto switching_point = at_origin(origin);
      if (!single.decide(before, switching_point, transition)) {
        ++left;
        continue;
      }
      ++(transition.state.mode[0] == 0 ? entries : crossings);
      expect_same(transition, decide_mode(switching_context, before, switching_point));
    }
  }
  // A quarter of all pairs of fields each way: crossing up and down, sliding, repelling.
  EXPECT_GT(crossings, 10);
  EXPECT_GT(entries, 10);
  EXPECT_GT(left, 10);
}

TEST(SingleSurface, DecidesExitsLikeTheGeneralDecision) {
  std::mt19937 random(20240612);
  const std::vector<double> origin(3, 0.0);
  int exits = 0;
  for (int k = 0; k < 60; ++k) {
    const auto system = random_fields(random, true);
    auto kernel = evaluation::ModelKernel::compile(system);
    ASSERT_TRUE(kernel.has_value());
    const SwitchingContext switching_context{*kernel, true, {}, {}};
    SingleSurface single(switching_context);
    Transition transition;
    ModeState before{{0}, {1.0}, {0}, {}};
    before.corner_alpha = {std::vector<double>{0.0}, std::vector<double>{1.0}};
    auto switching_point = at_origin(origin);
    switching_point.exit_above = {0};
    if (!single.decide(before, switching_point, transition)) continue;
    ++exits;
    EXPECT_EQ(transition.state.mode[0], 1);
    EXPECT_EQ(transition.zero_order[0], 2);
    expect_same(transition, decide_mode(switching_context, before, switching_point));
  }
  EXPECT_GT(exits, 8);  // an eighth of 60: the lower field points up, the upper one gets there
}

TEST(SingleSurface, DecidesBesideAnotherSurfaceOnWhichTheSolutionSlides) {
  std::mt19937 random(20240613);
  const std::vector<double> origin(5, 0.0);
  int decided = 0;
  for (int k = 0; k < 40; ++k) {
    // The same fields, and apart from them x5 = 0, where alpha = 0.65 before the event.
    const bool leaves = k % 2 != 0;
    const auto three = random_fields(random, leaves);
    auto s = testing::blank(5, 2);
    const auto inside = [&](const SX& e) {
      const SX arguments = SX::vertcat({three.t, three.x, three.alpha});
      return SX::substitute(e, arguments, SX::vertcat({s.t, s.x(0), s.x(1), s.x(2), s.alpha(0)}));
    };
    testing::add_surface(s, "s", inside(three.switching[0].psi));
    testing::add_surface(s, "other", s.x(4));
    const SX f = inside(three.f);
    testing::set_field(s, {f(0), f(1), f(2), s.x(0) + s.alpha(1), 0.6 - 2 * s.alpha(1) + 0.7 + s.x(3)}, origin);
    auto kernel = evaluation::ModelKernel::compile(s);
    ASSERT_TRUE(kernel.has_value());
    const SwitchingContext switching_context{*kernel, true, {}, {}};
    SingleSurface single(switching_context);
    Transition transition;
    ModeState before{{leaves ? 0 : -1, 0}, {leaves ? 1.0 : 0.0, 0.65}, {1}, {}};
    if (leaves) before.sliding = {0, 1};
    auto switching_point = at_origin(origin);
    switching_point.at_zero = {0, 1};
    if (leaves) switching_point.exit_above = {0};
    if (!single.decide(before, switching_point, transition)) continue;
    ++decided;
    expect_same(transition, decide_mode(switching_context, before, switching_point));
  }
  EXPECT_GT(decided, 8);
}

/// 40 blocks with friction in a row, of which all but the first slide, at random.
TEST(SingleSurface, RowsOfALargeFieldDecideLikeAllOfIt) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.3, 0.3);
  constexpr int blocks = 40;
  auto s = testing::blank(2 * blocks, blocks);
  std::vector<SX> f;
  for (int i = 0; i < blocks; ++i) {
    testing::add_surface(s, "s" + std::to_string(i), i % 2 == 0 ? s.x(2 * i + 1) : s.x(2 * i + 1) + 0.5 * s.x(2 * i));
    const SX left = i > 0 ? s.x(2 * i - 2) : SX(0), right = i + 1 < blocks ? s.x(2 * i + 2) : SX(0);
    f.push_back(s.x(2 * i + 1));
    f.push_back(left + right - 2 * s.x(2 * i) - 2 * s.alpha(i) + 1);
  }
  testing::set_field(s, f, std::vector<double>(2 * blocks, 0.0));
  auto kernel = evaluation::ModelKernel::compile(s);
  ASSERT_TRUE(kernel.has_value());
  const SwitchingContext switching_context{*kernel, true, {}, {}};
  SingleSurface single(switching_context);
  int decided = 0;
  for (int k = 0; k < 80; ++k) {
    std::vector<double> x(2 * blocks);
    for (int i = 0; i < blocks; ++i) {
      x[static_cast<std::size_t>(2 * i)] = number(random);
      x[static_cast<std::size_t>(2 * i + 1)] = i % 2 == 0 ? 0.0 : -0.5 * x[static_cast<std::size_t>(2 * i)];
    }
    const int touched = k % blocks;
    const bool leaves = k >= blocks;
    if (leaves) {  // the field of alpha = 1 is tangent to the surface: its force is -rate of what the tilt adds
      const auto q = [&](int i) { return i < 0 || i >= blocks ? 0.0 : x[static_cast<std::size_t>(2 * i)]; };
      const auto own = static_cast<std::size_t>(2 * touched);
      const double sum = q(touched - 1) + q(touched + 1) - 1.0;
      // v' + tilt v = 0, with v = -tilt q.
      const double tilt = touched % 2 == 0 ? 0.0 : 0.5;
      x[own] = sum / (2.0 + tilt * tilt);
      x[own + 1] = -tilt * x[own];
    }
    ModeState before;
    before.mode.assign(blocks, 0);
    before.alpha.assign(blocks, 0.5);
    before.mode[static_cast<std::size_t>(touched)] = leaves ? 0 : 1;
    for (int i = 0; i < blocks; ++i) {
      if (before.mode[static_cast<std::size_t>(i)] == 0) before.sliding.push_back(i);
    }
    if (!leaves) before.alpha[static_cast<std::size_t>(touched)] = 1.0;
    ModeField field(*kernel, true);
    field.enter(before);
    std::vector<double> slope(x.size());
    field(0.0, x.data(), slope.data());
    before.alpha = field.alpha();
    SwitchingPoint switching_point;
    switching_point.x = x.data();
    switching_point.time_scale = 0.1;
    for (int i = 0; i < blocks; ++i) switching_point.at_zero.push_back(i);
    switching_point.touched = {touched};
    if (leaves) switching_point.exit_above = {touched};
    Transition by_rows, by_all;
    const SingleSurface::Motion known{slope, field.solve()};
    const bool decides = single.decide(before, switching_point, by_rows, &known);
    EXPECT_EQ(decides, single.decide(before, switching_point, by_all)) << k;
    if (!decides) continue;
    ++decided;
    expect_same(by_rows, by_all);
  }
  EXPECT_GT(decided, 30);
}

TEST(SingleSurface, LeavesWhatIsNotSimpleToTheGeneralDecision) {
  const std::vector<double> origin(3, 0.0);
  auto s = testing::blank(3, 2);
  testing::add_surface(s, "inner", s.x(0));
  testing::add_surface(s, "outer", s.x(1) + s.alpha(0));
  testing::set_field(s, {SX(1), SX(1), s.alpha(1)}, {0, 0, 0});
  auto kernel = evaluation::ModelKernel::compile(s);
  ASSERT_TRUE(kernel.has_value());
  const SwitchingContext switching_context{*kernel, true, {}, {}};
  SingleSurface single(switching_context);
  Transition transition;
  const ModeState before{{-1, -1}, {0.0, 0.0}, {}, {}};
  auto switching_point = at_origin(origin);
  EXPECT_FALSE(single.decide(before, switching_point, transition)) << "a function is nested around it";
  switching_point.at_zero = {1};
  switching_point.touched = {1};
  EXPECT_TRUE(single.decide(before, switching_point, transition));
  switching_point.start = true;
  EXPECT_FALSE(single.decide(before, switching_point, transition)) << "a start";
  switching_point.start = false;
  switching_point.at_zero = {0, 1};
  EXPECT_FALSE(single.decide(before, switching_point, transition)) << "two surfaces";
}

/// x'' = -x, which crosses x = 0 and turns on something that does not matter.
long evaluations_of_oscillator(ode::Method method, FunctionRef<SX(const SX&)> psi, std::size_t events, long& steps) {
  auto s = testing::blank(3, 1);
  testing::add_surface(s, "s", psi(s.x));
  testing::set_field(s, {s.x(1), -s.x(0), 0.001 * s.alpha(0)}, {0.5, 1.0, 0.0});
  auto kernel = evaluation::ModelKernel::compile(s);
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-8, 1e-10};
  options.until = 100.0;
  const auto result = integrate(*kernel, options);
  EXPECT_EQ(result.status.termination, result::Termination::completed);
  EXPECT_EQ(result.events.size(), events);
  steps = static_cast<long>(result.statistics.steps);
  return static_cast<long>(result.statistics.rhs_evaluations);
}

auto threshold(double value) {
  return [value](const SX& x) { return x(0) - value; };
}

/// Along dop853's steps three more evaluations would make the dense output that is sampled.
TEST(CostOfAnEvent, IsNoneOfACurvedSurfaceThatIsFar) {
  long steps = 0;
  const auto circle = [](const SX& x) { return x(0) * x(0) + x(1) * x(1) - 9.0; };
  EXPECT_EQ(evaluations_of_oscillator(ode::Method::dop853, circle, 0, steps),
            evaluations_of_oscillator(ode::Method::dop853, threshold(9.0), 0, steps));
}

TEST(CostOfAnEvent, IsLessThanThreeSteps) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    long steps = 0;
    long steps_without = 0;
    const double pi = std::acos(-1.0);
    const auto events = static_cast<std::size_t>((100.0 + std::atan(0.5)) / pi);
    const long with = evaluations_of_oscillator(method, threshold(0.0), events, steps);
    const long without = evaluations_of_oscillator(method, threshold(2.0), 0, steps_without);
    const double a_step = static_cast<double>(without) / static_cast<double>(steps_without);
    EXPECT_LT(static_cast<double>(with - without), 3.0 * a_step * static_cast<double>(events));
  }
}

}  // namespace
}  // namespace saltus::event_integrator
