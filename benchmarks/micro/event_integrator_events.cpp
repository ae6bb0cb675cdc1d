// What do a crossing, an entry into sliding with its exit, and a step while sliding cost?
#include <string>
#include <utility>

#include "integrate_internal.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;

/// An oscillator whose first component passes the threshold twice a turn; above 1 it never does.
model::System oscillator(double threshold) {
  Builder b("oscillator");
  const SX x = b.state("x", {0.5});
  const SX v = b.state("v", {0.8});
  b.dynamics("x", v);
  b.dynamics("v", -x);
  const SX z = b.state("z", {0.0});
  b.dynamics("z", 0.01 * b.sign(x - threshold) - 0.1 * z);
  return std::move(*b.build());
}

/// The block on the belt (Dieci & Lopez): sticks and slips once a period.
model::System stick_slip() {
  Builder b("stick-slip");
  const SX q = b.state("q", {0.04});
  const SX v = b.state("v", {-0.01});
  b.dynamics("q", v);
  b.dynamics("v", -q + b.if_(model::greater(v - 0.2, 0), -1 / (0.8 + v), 1 / (1.2 - v)));
  return std::move(*b.build());
}

/// The same oscillator, driven through a first component that slides all the time on a surface across both axes.
model::System slides(double slope) {
  Builder b("slides");
  const SX s = b.state("s", {0.0});
  const SX x = b.state("x", {0.0});
  const SX v = b.state("v", {0.8});
  b.dynamics("s", 0.5 * x - 2 * b.sign(s + slope * x));
  b.dynamics("x", v);
  b.dynamics("v", -x);
  return std::move(*b.build());
}

void run(benchmark::State& state, const model::System& system, ode::Method method) {
  const Integration result = integrate_repeatedly(state, system, method);
  state.counters["events"] = static_cast<double>(result.events.size());
  state.counters["evaluations"] = static_cast<double>(result.statistics.rhs_evaluations);
}

void no_event(benchmark::State& state, ode::Method method) { run(state, oscillator(2.0), method); }
BENCHMARK_CAPTURE(no_event, dopri5, ode::Method::dopri5)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(no_event, dop853, ode::Method::dop853)->Unit(benchmark::kMicrosecond);

void crossings(benchmark::State& state, ode::Method method) { run(state, oscillator(0.0), method); }
BENCHMARK_CAPTURE(crossings, dopri5, ode::Method::dopri5)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(crossings, dop853, ode::Method::dop853)->Unit(benchmark::kMicrosecond);

void entries_and_exits(benchmark::State& state, ode::Method method) { run(state, stick_slip(), method); }
BENCHMARK_CAPTURE(entries_and_exits, dopri5, ode::Method::dopri5)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(entries_and_exits, dop853, ode::Method::dop853)->Unit(benchmark::kMicrosecond);

/// On a coordinate, and on a plane across coordinates.
void sliding_steps(benchmark::State& state, double slope) { run(state, slides(slope), ode::Method::dop853); }
BENCHMARK_CAPTURE(sliding_steps, coordinate, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(sliding_steps, plane, 0.5)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace saltus::event_integrator
