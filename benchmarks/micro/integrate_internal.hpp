// What the benchmarks of whole integrations share.
#pragma once

#include <benchmark/benchmark.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {

/// Integrates to t = 1000 at 1e-8 with native code, keeping events and end state only, and counts the time per step
/// and, where there are events, per event.
inline Integration integrate_repeatedly(benchmark::State& state, const model::System& system, ode::Method method) {
  auto kernel = evaluation::ModelKernel::compile(system, evaluation::NativeCode::on);
  if (!kernel) {
    state.SkipWithError(kernel.error().message.c_str());
    return {};
  }
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-8, 1e-10};
  options.until = 1000.0;
  options.output.rows = OutputTimes::Rows::at_times;
  Integration result;
  for (auto _ : state) {
    result = integrate(*kernel, options);
    benchmark::DoNotOptimize(result);
  }
  if (result.status.termination != result::Termination::completed) state.SkipWithError(result.status.message.c_str());
  const auto each = [&](double count) {
    return benchmark::Counter(count * static_cast<double>(state.iterations()),
                              benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  };
  const auto steps = static_cast<double>(result.statistics.steps);
  const auto events = static_cast<double>(result.events.size());
  state.counters["steps"] = steps;
  state.counters["per_step"] = each(steps);
  if (events > 0.0) state.counters["per_event"] = each(events);
  return result;
}

}  // namespace saltus::event_integrator
