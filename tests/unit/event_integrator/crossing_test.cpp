// The fast path behind ordinary switches and the full decision give the same recording, bit for bit; so does what has
// come of each instant, resolved once more.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "saltus/event_integrator/run/run_internal.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

constexpr auto all_methods = {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor};

CompactIntegration run(const model::System& system, const IntegrationOptions& options, Run::Way way) {
  auto kernel = evaluation::ModelKernel::compile(system);
  EXPECT_TRUE(kernel.has_value());
  return Run(*kernel, options, way).to_end({});
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0) << what;
}

void expect_same(const Recording& a, const Recording& b) {
  ASSERT_EQ(a.event_list.size(), b.event_list.size());
  for (std::size_t k = 0; k < a.event_list.size(); ++k) {
    const auto& one = a.event_list[k];
    const auto& other = b.event_list[k];
    EXPECT_EQ(one.t, other.t) << k;
    EXPECT_EQ(one.kind, other.kind) << k;
    EXPECT_EQ(one.x, other.x) << k;
    EXPECT_EQ(one.x_after, other.x_after) << k;
    EXPECT_EQ(one.mode, other.mode) << k;
    EXPECT_EQ(one.mode_after, other.mode_after) << k;
    EXPECT_EQ(one.unique, other.unique) << k;
    EXPECT_EQ(one.surfaces.begin, other.surfaces.begin) << k;
    EXPECT_EQ(one.surfaces.end, other.surfaces.end) << k;
    const auto words = [](const Recording& recording, const Recording::Range& place) {
      return recording.text.substr(place.begin, place.end - place.begin);
    };
    EXPECT_EQ(words(a, one.reason), words(b, other.reason)) << k;
    EXPECT_EQ(one.meeting, other.meeting) << k;
  }
  ASSERT_EQ(a.meetings.size(), b.meetings.size());
  for (std::size_t k = 0; k < a.meetings.size(); ++k) {
    EXPECT_EQ(a.meetings[k].surfaces, b.meetings[k].surfaces) << k;
    EXPECT_EQ(a.meetings[k].velocities, b.meetings[k].velocities) << k;
    EXPECT_EQ(a.meetings[k].alpha, b.meetings[k].alpha) << k;
  }
  EXPECT_EQ(a.surfaces, b.surfaces);
  EXPECT_EQ(a.row_modes, b.row_modes);
  expect_same_bits(a.states, b.states, "states at events");
  expect_same_bits(a.row_times, b.row_times, "times of rows");
  expect_same_bits(a.row_states, b.row_states, "states of rows");
  expect_same_bits(a.row_outputs, b.row_outputs, "outputs");
  ASSERT_EQ(a.modes.size(), b.modes.size());
  ModeLog::Reader one(a.modes), other(b.modes);
  for (std::size_t k = 0; k < a.modes.size(); ++k) {
    one.seek(k);
    other.seek(k);
    ASSERT_EQ(one.mode(), other.mode()) << k;
    expect_same_bits(one.alpha(), other.alpha(), "selections");
  }
}

/// The same events in the same modes; states to the rounding of a projection that is made once more, which motions may
/// make larger.
void expect_same_events(const CompactIntegration& a, const CompactIntegration& b, double tolerance) {
  EXPECT_EQ(a.status.termination, b.status.termination) << a.status.message << b.status.message;
  ASSERT_EQ(a.recording.event_list.size(), b.recording.event_list.size());
  for (std::size_t k = 0; k < a.recording.event_list.size(); ++k) {
    const auto& one = a.recording.event_list[k];
    const auto& other = b.recording.event_list[k];
    EXPECT_NEAR(one.t, other.t, tolerance) << k;
    EXPECT_EQ(one.kind, other.kind) << k;
    EXPECT_EQ(one.mode, other.mode) << k;
    EXPECT_EQ(one.mode_after, other.mode_after) << k;
    EXPECT_EQ(one.unique, other.unique) << k;
  }
  ASSERT_EQ(a.recording.states.size(), b.recording.states.size());
  for (std::size_t k = 0; k < a.recording.states.size(); ++k) {
    EXPECT_NEAR(a.recording.states[k], b.recording.states[k], tolerance * (1.0 + std::abs(b.recording.states[k])));
  }
}

/// Returns how many evaluations of the field the fast path saves.
long compare(const model::System& system, IntegrationOptions options) {
  const auto quick = run(system, options, Run::Way::fast_where_ordinary);
  const auto full = run(system, options, Run::Way::full);
  EXPECT_EQ(quick.status.termination, full.status.termination) << quick.status.message << full.status.message;
  EXPECT_EQ(quick.status.message, full.status.message);
  EXPECT_EQ(quick.status.time_reached, full.status.time_reached);
  EXPECT_EQ(quick.statistics.steps, full.statistics.steps);
  EXPECT_EQ(quick.statistics.rejected, full.statistics.rejected);
  expect_same(quick.recording, full.recording);
  expect_same_events(run(system, options, Run::Way::full_twice), full, 0.1 * options.tolerances.rtol);
  return full.statistics.rhs_evaluations - quick.statistics.rhs_evaluations;
}

IntegrationOptions options_of(ode::Method method, double until, OutputTimes::Rows rows) {
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-8, 1e-10};
  options.until = until;
  options.output.rows = rows;
  if (rows == OutputTimes::Rows::at_times) {
    for (int k = 1; k <= 20; ++k) options.output.times.push_back(until * k / 20);
  }
  return options;
}

/// The fast path is taken, which takes fewer evaluations, or as many.
void expect_agreement(const model::System& system, double until) {
  for (const auto method : all_methods) {
    for (const auto rows : {OutputTimes::Rows::at_steps, OutputTimes::Rows::at_times}) {
      EXPECT_GE(compare(system, options_of(method, until, rows)), 0) << static_cast<int>(method);
    }
  }
}

TEST(FastPath, EntersAndLeavesSlidingAsTheFullDecision) { expect_agreement(testing::stick_slip(), 40.0); }

TEST(FastPath, PassesTangentialExitsAsTheFullDecision) { expect_agreement(testing::relay(), 6.0); }

TEST(FastPath, TouchesSeveralIndependentSurfacesAsTheFullDecision) {
  expect_agreement(testing::friction_blocks(), 20.0);
}

/// An oscillator drives s, which slides on 0, and r, which passes 0.2 meanwhile; `coupling` of each selection is in the
/// other rate; `bend` is that of the surface that is slid on.
model::System sliding_across(double coupling, double bend) {
  auto system = testing::blank(4, 2);
  testing::add_surface(system, "s", system.x(2) - bend * system.x(2) * system.x(2));
  testing::add_surface(system, "r", system.x(3) - 0.2);
  const auto s = 2 * system.alpha(0) - 1, r = 2 * system.alpha(1) - 1;
  testing::set_field(system,
                     {system.x(1), -system.x(0), 0.5 * system.x(0) - 2 * s + coupling * r,
                      1.5 * system.x(1) - 0.2 * system.x(3) - 0.05 * r + 0.25 * coupling * s},
                     {0.5, 0.8, 0.0, 0.7});
  return system;
}

TEST(FastPath, PassesASurfaceThatTheSlidingFeelsAsTheFullDecision) {
  expect_agreement(sliding_across(0.2, 0.2), 20.0);
  expect_agreement(sliding_across(0.2, 0.0), 20.0);
}

TEST(FastPath, PassesASurfaceWhileSlidingOnOneThatDoesNotFeelItAsTheFullDecision) {
  expect_agreement(sliding_across(0.0, 0.0), 20.0);
}

TEST(FastPath, CrossesSurfacesThatDependOnTimeAsTheFullDecision) {
  auto system = testing::blank(2, 2);
  testing::add_surface(system, "moving", system.x(0) - 0.3 * system.t);
  testing::add_surface(system, "curved", system.x(0) * system.x(1) - 0.1);
  testing::set_field(system,
                     {system.x(1) + 0.3 * system.alpha(0), -system.x(0) + 0.2 * system.alpha(1) - 0.1 * system.x(1)},
                     {1.0, 0.1});
  expect_agreement(system, 20.0);
}

/// The matrix of the field that is slid on changes at the other surface, which only its linear part knows.
TEST(FastPath, CrossesWhileSlidingWhereTheMatrixChangesAsTheFullDecision) {
  auto system = testing::blank(3, 2);
  testing::add_surface(system, "held", system.x(0));
  testing::add_surface(system, "turns", system.x(1));
  testing::set_field(system,
                     {0.3 * system.x(1) + 1 - 2 * system.alpha(0) + 0.2 * system.alpha(1), system.x(2),
                      -(1 + 3 * system.alpha(1)) * system.x(1)},
                     {0.2, 1.0, 0.0});
  for (const auto method : all_methods) {
    static_cast<void>(compare(system, options_of(method, 20.0, OutputTimes::Rows::at_steps)));
  }
}

/// Switches that contract towards an equilibrium: cycles, tolerances that follow them, and the limit.
TEST(FastPath, FollowsAccumulationsAsTheFullDecision) {
  auto system = testing::blank(2, 2);
  testing::add_surface(system, "x", system.x(0));
  testing::add_surface(system, "y", system.x(1));
  const auto a = 2 * system.alpha(0) - 1, b = 2 * system.alpha(1) - 1;
  testing::set_field(system, {-b - 0.3 * a, a - 0.3 * b}, {1.0, 0.4});
  expect_agreement(system, 30.0);
}

/// x' = A x + b + sum_j c_j sgn(n_j . x - d_j): crossings, sliding on one surface and on several, their meetings.
model::System random_system(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  const int n = 2 + static_cast<int>(seed % 3);
  const int surfaces = 1 + static_cast<int>(seed / 3 % 4);
  auto system = testing::blank(n, surfaces);
  for (int j = 0; j < surfaces; ++j) {
    casadi::SX psi = 0.3 * number();
    for (int i = 0; i < n; ++i) psi += (seed % 2 == 0 && i != j % n ? 0.0 : number()) * system.x(i);
    testing::add_surface(system, "s" + std::to_string(j), psi);
  }
  std::vector<casadi::SX> f;
  std::vector<double> start;
  for (int i = 0; i < n; ++i) {
    casadi::SX rate = 0.3 * number() - 0.2 * system.x(i);
    for (int k = 0; k < n; ++k) rate += (k == i ? 0.0 : 2.0 * number()) * system.x(k);
    for (int j = 0; j < surfaces; ++j) rate += number() * (2 * system.alpha(j) - 1);
    f.push_back(rate);
    start.push_back(number());
  }
  testing::set_field(system, f, start);
  return system;
}

TEST(FastPath, AgreesOnRandomSystems) {
  long saved = 0;
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    const auto method = *(all_methods.begin() + seed % 3);
    saved += compare(random_system(seed), options_of(method, 8.0, OutputTimes::Rows::at_steps));
  }
  EXPECT_GT(saved, 500);
}

}  // namespace
}  // namespace saltus::event_integrator
