#include <cstddef>
#include <memory>
#include <utility>

#include "saltus/base/stopwatch.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/options/element_choices_internal.hpp"
#include "saltus/pipeline/simulate/dropped_under_lock_internal.hpp"
#include "saltus/pipeline/simulate/methods_internal.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/pipeline/simulate/step_observer_internal.hpp"
#include "saltus/smoothed/regularise.hpp"
#include "saltus/smoothed/restate.hpp"

namespace saltus::pipeline {
namespace {

using smoothed::Regularisation;

Expected<std::shared_ptr<const Regularisation>> regularised(const model::System& system, double epsilon) {
  const SymbolicLock lock;
  return smoothed::regularise(system, epsilon).map([](Regularisation made) {
    return dropped_under_lock(std::move(made));
  });
}

/// How many of the last outputs are selections.
std::size_t selections_of(const Regularisation& regularisation) {
  std::size_t count = regularisation.columns.size();
  for (const auto& group : regularisation.regions) count += group.names.size();
  return count;
}

event_integrator::ThinLayers layers_of(const Regularisation& regularisation) {
  event_integrator::ThinLayers layers;
  layers.half_width = regularisation.epsilon;
  const auto function = [&](std::size_t column) { return regularisation.system.columns[column].function; };
  for (const auto& layer : regularisation.layers) {
    for (const auto& side : layer.sides) {
      if (side.lower != side.upper) layers.corners.push_back({function(side.lower), function(side.upper)});
    }
  }
  for (const auto& regions : regularisation.regions) {
    for (const std::size_t column : regions.columns) layers.weights.push_back(function(column));
  }
  layers.weight_range = smoothed::weight_range * regularisation.epsilon;
  return layers;
}

/// What was computed, over the columns of the original system.
void restate_run(const Regularisation& regularisation, event_integrator::Integration& run) {
  smoothed::restate(regularisation, run.events, run.trajectory, run.status);
  const auto& rows = run.trajectory;
  run.final.mode = rows.mode.back();
  run.final.alpha = rows.alpha.back();
  run.final.outputs = rows.outputs.back();
  if (rows.regions.empty()) return;
  run.final.regions = rows.regions.back();
  run.final.theta = rows.theta.back();
}

void restate_rows(const Regularisation& regularisation, result::Trajectory& rows) {
  if (rows.t.empty()) return;
  result::Events none;
  result::Status status;
  smoothed::restate(regularisation, none, rows, status);
}

}  // namespace

Expected<result::Result> simulate_smoothed(const Simulation& asked, KernelStore& kernels) {
  const Stopwatch watch;
  const auto& options = asked.options;
  const auto made = regularised(asked.system, options.smoothed.epsilon);
  if (!made) return tl::unexpected(made.error());
  const auto& regularisation = *made;
  const std::shared_ptr<const model::System> system(regularisation, &regularisation->system);
  auto kept = kernels.take(*system, native_code(options.native));
  if (!kept) return tl::unexpected(kept.error());

  auto integration = event_options(asked, Integrator::radau5);  // the layers make every model stiff
  integration.layers = layers_of(*regularisation);
  integration.output.selections = selections_of(*regularisation);
  const auto observer = step_observer(asked.observers, {integration.from, integration.until});
  auto run = event_integrator::integrate(kept->kernel, integration, observer);
  restate_run(*regularisation, run);
  auto result = asked.frame;
  add_run(run, result);
  if (options.continuous) {
    const EventRun of_it{system, integration, native_code(options.native),
                         [regularisation](auto& rows) { restate_rows(*regularisation, rows); }};
    result.continuous = continuous(result.trajectory, of_it, kept->kernel, std::move(run.pieces));
  }
  if (!has_event_rows(options)) leave_out_event_rows(wanted_rows(options.output, asked.times), result.trajectory);
  result.statistics.wall_seconds = watch.seconds();
  kernels.give_back(std::move(*kept));
  return result;
}

}  // namespace saltus::pipeline
