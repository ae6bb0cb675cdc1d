// How many steps does an event cost, where one surface is met, and where a second one is met while sliding on a first?
#include <ctime>
#include <utility>

#include "integrate_internal.hpp"
#include "saltus/event_integrator/run/compact_integration.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;

/// An oscillator (x, v) of amplitude 0.94 that drives what follows.
std::pair<SX, SX> oscillator(Builder& b) {
  const SX x = b.state("x", {0.5});
  const SX v = b.state("v", {0.8});
  b.dynamics("x", v);
  b.dynamics("v", -x);
  return {x, v};
}

/// x passes `threshold` twice a turn; above 1 it never does.
model::System crossings(double threshold) {
  Builder b("crossings");
  const SX x = oscillator(b).first;
  const SX z = b.state("z", {0.0});
  b.dynamics("z", 0.01 * b.sign(x - threshold) - 0.1 * z);
  return std::move(*b.build());
}

/// Slides on s = 0 all the time; r passes `threshold` twice a turn, above 3 it never does. Both selections are in both
/// rates: where r passes, two surfaces that influence each other meet.
model::System intersections(double threshold) {
  Builder b("intersections");
  const auto [x, v] = oscillator(b);
  const SX s = b.state("s", {0.0});
  const SX r = b.state("r", {0.7});
  b.dynamics("s", 0.5 * x - 2 * b.sign(s) + 0.2 * b.sign(r - threshold));
  b.dynamics("r", 1.5 * v - 0.2 * r - 0.05 * b.sign(r - threshold) + 0.05 * b.sign(s));
  return std::move(*b.build());
}

struct Measured {
  double seconds = 0.0;
  long steps = 0, events = 0;
};

using Rows = OutputTimes::Rows;  ///< at steps: the default; at_times: none but at events

Measured run(evaluation::ModelKernel& kernel, ode::Method method, Rows rows) {
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-8, 1e-10};
  options.until = 1000.0;
  options.output.rows = rows;
  const std::clock_t begin = std::clock();  // of the processor: other work on the machine does not count
  const CompactIntegration result = integrate_compact(kernel, options);
  const std::clock_t end = std::clock();
  if (result.status.termination != result::Termination::completed) return {};
  return {static_cast<double>(end - begin) / CLOCKS_PER_SEC, result.statistics.steps,
          static_cast<long>(result.recording.event_list.size())};
}

/// The run with events and the one without take turns. `event_in_steps`: all that an event costs, in steps of the run
/// without: what the run with events takes longer, its shorter steps before and behind events included.
/// `decision_in_steps`: the same without the steps that it takes more, that is searching, locating, deciding, recording
/// and restarting.
void compare(benchmark::State& state, const model::System& with, const model::System& without, ode::Method method,
             Rows rows) {
  auto kernel = evaluation::ModelKernel::compile(with, evaluation::NativeCode::on);
  auto plain = evaluation::ModelKernel::compile(without, evaluation::NativeCode::on);
  if (!kernel || !plain) {
    state.SkipWithError((kernel ? plain : kernel).error().message.c_str());
    return;
  }
  Measured events, steps;
  for (auto _ : state) {
    const Measured one = run(*kernel, method, rows);
    const Measured other = run(*plain, method, rows);
    events = {events.seconds + one.seconds, events.steps + one.steps, events.events + one.events};
    steps = {steps.seconds + other.seconds, steps.steps + other.steps, steps.events + other.events};
  }
  const auto turns = static_cast<long>(state.iterations());
  if (steps.events > turns || events.events < 100 * turns) state.SkipWithError("events are not where they should be");
  const double step = steps.seconds / static_cast<double>(steps.steps);
  const auto number = static_cast<double>(events.events);
  const double event = (events.seconds - steps.seconds) / number;
  const double decision = (events.seconds - step * static_cast<double>(events.steps)) / number;
  state.counters["events"] = number / static_cast<double>(turns);
  state.counters["steps"] = static_cast<double>(events.steps) / static_cast<double>(turns);
  state.counters["plain_steps"] = static_cast<double>(steps.steps) / static_cast<double>(turns);
  state.counters["step_ns"] = 1e9 * step;
  state.counters["event_ns"] = 1e9 * event;
  state.counters["event_in_steps"] = event / step;
  state.counters["decision_in_steps"] = decision / step;
}

void codimension_one(benchmark::State& state, ode::Method method, Rows rows) {
  compare(state, crossings(0.0), crossings(2.0), method, rows);
}

void codimension_two(benchmark::State& state, ode::Method method, Rows rows) {
  compare(state, intersections(0.0), intersections(5.0), method, rows);
}

#define SALTUS_EVENT_IN_STEPS(where, method)                                                            \
  BENCHMARK_CAPTURE(where, method, ode::Method::method, Rows::at_steps)->Unit(benchmark::kMicrosecond); \
  BENCHMARK_CAPTURE(where, method##_bare, ode::Method::method, Rows::at_times)->Unit(benchmark::kMicrosecond)

SALTUS_EVENT_IN_STEPS(codimension_one, dopri5);
SALTUS_EVENT_IN_STEPS(codimension_one, dop853);
SALTUS_EVENT_IN_STEPS(codimension_one, taylor);
SALTUS_EVENT_IN_STEPS(codimension_two, dopri5);
SALTUS_EVENT_IN_STEPS(codimension_two, dop853);
SALTUS_EVENT_IN_STEPS(codimension_two, taylor);

}  // namespace
}  // namespace saltus::event_integrator
