// The parts of a run, each alone: tolerances, rates, rows, attempts, zeros, accumulation.
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/approach/zero_approach.hpp"
#include "saltus/event_integrator/record/output_rows.hpp"
#include "saltus/event_integrator/search/search_values.hpp"
#include "saltus/event_integrator/sequences/switch_accumulation.hpp"
#include "saltus/event_integrator/steps/method_choice.hpp"
#include "saltus/event_integrator/steps/step_attempt.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/model/layout.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using Reason = StepTolerances::Reason;

/// What every part needs, at the start of a system in one of its regions.
struct Scene {
  explicit Scene(const model::System& stated, IntegrationOptions asked = {})
      : system(stated), options(std::move(asked)), kernel(*evaluation::ModelKernel::compile(system)) {
    here.state.mode.assign(system.switching.size(), 0);
    here.state.alpha = here.state.corner_alpha[0] = std::vector<double>(system.switching.size(), 0.0);
    for (std::size_t j = 0; j < system.switching.size(); ++j) set_surface(here.state, static_cast<int>(j), -1, 0.0);
    field.enter(here.state);
    field(here.t, here.x.data(), here.slope.data());
    search.enter(here.state, std::vector<int>(system.switching.size(), 0), here.t, here.x.data());
  }

  const model::System system;
  const IntegrationOptions options;
  evaluation::ModelKernel kernel;
  const SwitchingContext switching_context{kernel, true, {}, {}};
  ModeField field{kernel, true};
  Position here{options.from, system.initial_state};
  StepTolerances tolerances{options.tolerances};
  Ledger ledger{kernel};
  EventSearch search{kernel, field, ledger, options.method, tolerances.step()};
};

TEST(StepTolerances, AreTheProductOfTheirParts) {
  StepTolerances tolerances({.rtol = 1e-6, .atol = 1e-8});
  const auto mode = tolerances.mode();
  EXPECT_DOUBLE_EQ(mode.rtol, 1e-7);  // a tenth of what is asked for
  EXPECT_DOUBLE_EQ(mode.atol, 1e-9);
  tolerances.limit(Reason::coalescence, {.rtol = 0.5, .atol = 0.5});
  tolerances.limit(Reason::cycles, {.rtol = 1.0, .atol = 0.25});
  tolerances.limit(Reason::zeros, {.rtol = 0.125, .atol = 1.0});
  EXPECT_EQ(tolerances.step().rtol, 0.0625 * mode.rtol);  // powers of two: exact
  EXPECT_EQ(tolerances.step().atol, 0.125 * mode.atol);
  tolerances.lift(Reason::cycles);
  EXPECT_EQ(tolerances.step().atol, 0.5 * mode.atol);
}

TEST(StepTolerances, AModeHasNoRootOfTheOneBefore) {
  Scene scene(testing::sign_system(0.5, -1.0, -0.25));
  StepTolerances tolerances({.rtol = 1e-6, .atol = 1e-8});
  tolerances.limit(Reason::coalescence, {.rtol = 0.5, .atol = 0.5});
  tolerances.limit(Reason::cycles, {.rtol = 1.0, .atol = 0.25});
  tolerances.begin_mode(scene.kernel, {}, scene.here);
  EXPECT_EQ(tolerances.step().rtol, tolerances.mode().rtol);
  EXPECT_EQ(tolerances.step().atol, 0.25 * tolerances.mode().atol);  // cycles go on from mode to mode
}

TEST(FieldRates, DifferentiateAlongAField) {
  Scene scene(testing::stick_slip());
  FieldRates rates(scene.kernel, scene.here);
  EXPECT_EQ(rates.here(0).value, scene.here.slope[1]);  // psi = x2 - 0.2
  EXPECT_EQ(rates.here(0).magnitude, std::abs(scene.here.x[1]));
  EXPECT_EQ(rates.here(0).slope, 1.0);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(rates.along(0, {infinite, 3.0}).value, 3.0);  // 0 times infinity is none of it
}

TEST(OutputRows, PassEveryRequestedTimeOnce) {
  IntegrationOptions options;
  options.output = {OutputTimes::Rows::at_times, {0.0, 0.25, 0.5, 0.75, 1.0}};
  Scene scene(testing::sign_system(0.5, -1.0, -0.25), options);
  Holding holding(scene.kernel);
  Recorder recorder(scene.kernel);
  OutputRows rows(scene.kernel, scene.options, scene.here, scene.field, holding, recorder);
  rows.skip_here();
  EXPECT_FALSE(rows.any_before(0.25));
  EXPECT_TRUE(rows.any_before(0.3));
  rows.write_before(0.5, [](double t, double* x) { *x = t; });
  scene.here.t = 0.5;
  rows.write_end_of_step();
  rows.write_end_of_step();  // once only
  std::vector<double> times;
  rows.each_until(0.5, 1.0, [&](double t) { times.push_back(t); });
  EXPECT_EQ(times, (std::vector<double>{0.75, 1.0}));
  EXPECT_FALSE(rows.any_before(2.0));
  const auto recording = recorder.take();
  EXPECT_EQ(recording.row_times, (std::vector<double>{0.25, 0.5}));
}

TEST(StepAttempt, HasADenseOutputOfItsLastAttemptOnly) {
  Scene scene(testing::sign_system(0.5, -1.0, -4.0));  // x' = 1.5 below 0
  StepAttempt steps(scene.options, scene.kernel.layout(), scene.field, scene.here, scene.tolerances);
  ASSERT_EQ(steps.take(1.0), ode::Attempt::finite);
  ASSERT_TRUE(steps.make_dense());
  EXPECT_EQ(steps.dense().h, 1.0);
  ASSERT_EQ(steps.take(0.5), ode::Attempt::finite);
  ASSERT_TRUE(steps.make_dense());
  EXPECT_EQ(steps.dense().h, 0.5);
  double x = 0.0;
  steps.dense().evaluate(1.0, &x);
  EXPECT_NEAR(x, -3.25, 4e-15);  // eight roundings of 4
  EXPECT_EQ(scene.here.t, 0.0);  // an attempt moves nothing
  EXPECT_LE(steps.confirmed_error(), 1.0);
  EXPECT_GT(steps.initial_step(), 0.0);
}

TEST(ZeroApproach, FindsASurfaceThatTheStateIsOnOnTheWayThereOnly) {
  auto system = testing::blank(1, 1);
  testing::add_surface(system, "x", system.x(0) - 1);
  testing::set_field(system, {0.5 - (2 * system.alpha(0) - 1)}, {1.0});
  Scene scene(system);
  ZeroApproach zeros(scene.switching_context, scene.here, scene.field, scene.search);
  const auto located = zeros.within_rounding();
  ASSERT_TRUE(located.has_value());
  EXPECT_EQ(located->x.front(), 1.0);
  EXPECT_EQ(located->signs, std::vector<int>{-1});
  scene.here.slope = {-1.0};  // away from it
  EXPECT_FALSE(zeros.within_rounding().has_value());
  EXPECT_EQ(zeros.unresolved().size(), 1U);  // but zero as far as is known
  EXPECT_EQ(zeros.root_here(), -1);          // and no root
}

TEST(SwitchAccumulation, FollowsCyclesToTheirLimit) {
  Scene scene(testing::friction_blocks());
  SwitchAccumulation switches(scene.switching_context, scene.here, 10.0, scene.tolerances);
  // Two surfaces in turn, at t = 1 - 2^-k: the limit is 1.
  std::optional<SeriesLimit> limit;
  double share = 1.0;
  for (int k = 1; k < 45 && !limit; ++k) {
    const ModeState before = scene.here.state;
    const int surface = k % 2;
    scene.here.t = 1.0 - std::ldexp(1.0, -k);
    set_surface(scene.here.state, surface, -before.mode[static_cast<std::size_t>(surface)], 0.5);
    const ModeChange change{.mode_before = &before, .mode_after = &scene.here.state};
    switches.series().note(scene.here.t, change);
    switches.note(change);
    switches.limit_tolerances(SwitchAccumulation::Roots::none);
    EXPECT_LE(scene.tolerances.part(Reason::cycles).atol, share);
    share = scene.tolerances.part(Reason::cycles).atol;
    limit = switches.limit();
  }
  ASSERT_TRUE(limit.has_value());
  EXPECT_NEAR(limit->t, 1.0, 1e-12);
  EXPECT_LT(share, 1e-3);
  EXPECT_TRUE(switches.cycle().has_value());
  switches.clear();
  switches.limit_tolerances(SwitchAccumulation::Roots::none);
  EXPECT_EQ(scene.tolerances.part(Reason::cycles).atol, 1.0);
  EXPECT_FALSE(switches.cycle().has_value());
}

/// Steps along x' = -rate (x - cos t) by the method of the choice: of length h, implicit ones ten times as long.
void take_steps(MethodChoice& choice, Position& here, double rate, double h, int steps) {
  const ode::Tolerances tolerances{1e-6, 1e-6};
  auto stepper = ode::Stepper(choice.method(), 1);
  for (int k = 0; k < steps; ++k) {
    if (stepper.method() != choice.method()) stepper = ode::Stepper(choice.method(), 1);
    const auto field = [&](double time, const double* x, double* slope) { slope[0] = -rate * (x[0] - std::cos(time)); };
    double slope = 0.0;
    field(here.t, here.x.data(), &slope);
    const double length = ode::is_implicit(stepper.method()) ? 10.0 * h : h;
    ASSERT_EQ(stepper.attempt(field, here.t, here.x.data(), &slope, length, tolerances), ode::Attempt::finite);
    here.t += length;
    here.x[0] = stepper.x_new()[0];
    choice.count(stepper.method(), length);
    choice.accepted(stepper, tolerances, true);
  }
}

// Steps at the border of stability of dopri5 are stiff, whatever mode they are in; the other mode is not.
TEST(MethodChoice, BelongsToItsMode) {
  IntegrationOptions options;
  options.chooses_method = true;
  Position here(0.0, {1.0});
  here.state.mode = {1};
  MethodChoice choice(options, here);
  choice.begin_mode();
  take_steps(choice, here, 1e4, 3.3e-4, 300);
  EXPECT_TRUE(ode::is_implicit(choice.method()));
  EXPECT_FALSE(choice.stiff_at().has_value());
  const ode::Method stiff = choice.method();
  here.state.mode = {-1};
  choice.begin_mode();
  take_steps(choice, here, 1.0, 1e-2, 40);  // an explicit step could be as long
  EXPECT_EQ(choice.method(), ode::Method::dopri5);
  here.state.mode = {1};
  choice.begin_mode();
  EXPECT_EQ(choice.method(), stiff);
  long steps = 0;
  for (const auto& use : choice.uses()) steps += use.steps;
  EXPECT_EQ(steps, 340);
}

TEST(MethodChoice, StaysWhereItIsNamedOrNewtonFails) {
  IntegrationOptions options;
  Position here(0.0, {1.0});
  here.state.mode = {1};
  MethodChoice named(options, here);
  named.begin_mode();
  take_steps(named, here, 1e4, 3.3e-4, 300);
  EXPECT_EQ(named.method(), ode::Method::dopri5);
  EXPECT_TRUE(named.stiff_at().has_value());
  EXPECT_TRUE(named.uses().empty());
  options.chooses_method = true;
  MethodChoice choice(options, here);
  choice.begin_mode();
  take_steps(choice, here, 1e4, 3.3e-4, 300);
  const auto fail = [&](ode::Stages stages) {
    for (int attempt = 0; attempt < 6; ++attempt) choice.failed(stages);
    EXPECT_EQ(choice.method(), ode::Method::dopri5);
  };
  // Where the right-hand side is undefined is a place, and no property of the mode.
  fail(ode::Stages::undefined);
  EXPECT_FALSE(choice.failure().has_value());
  take_steps(choice, here, 1e4, 3.3e-4, 300);
  EXPECT_TRUE(ode::is_implicit(choice.method()));
  fail(ode::Stages::not_found);
  ASSERT_TRUE(choice.failure().has_value());
  EXPECT_EQ(choice.failure()->t, here.t);
  EXPECT_EQ(choice.failure()->stages, ode::Stages::not_found);
  take_steps(choice, here, 1e4, 3.3e-4, 300);
  EXPECT_EQ(choice.method(), ode::Method::dopri5);
  EXPECT_TRUE(choice.stiff_at().has_value());
  // What failed in that mode says nothing of another one.
  here.state.mode = {-1};
  choice.begin_mode();
  take_steps(choice, here, 1e4, 3.3e-4, 300);
  EXPECT_TRUE(ode::is_implicit(choice.method()));
}

// Tolerances leave at least what rounding leaves; a level that is not finite says nothing.
TEST(FunctionLevels, AccuracyIsAtLeastTheRounding) {
  FunctionLevels levels;
  levels.reset(2);
  levels.set(0, 1e-14, 1e-15);
  EXPECT_EQ(levels.accuracy[0], 1e-14);
  levels.set(1, std::numeric_limits<double>::quiet_NaN(), 1e-9);
  EXPECT_EQ(levels.noise[1], 0.0);
  EXPECT_EQ(levels.accuracy[1], 1e-9);
}

TEST(SwitchAccumulation, EndsWhereLimitsFollowEachOtherAtOnce) {
  Scene scene(testing::friction_blocks());
  SwitchAccumulation switches(scene.switching_context, scene.here, 10.0, scene.tolerances);
  for (int k = 1; k < 8; ++k) EXPECT_FALSE(switches.limits_repeat(1.0)) << k;
  EXPECT_TRUE(switches.limits_repeat(1.0));
  EXPECT_FALSE(switches.limits_repeat(2.0));
}

}  // namespace
}  // namespace saltus::event_integrator
