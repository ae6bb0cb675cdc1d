#include <utility>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/integrand_internal.hpp"
#include "saltus/smoothed/regularise.hpp"
#include "saltus/smoothed/restate.hpp"

namespace saltus::pipeline {

std::shared_ptr<const model::System> own_copy(const model::System& system) {
  const SymbolicLock lock;
  return {new model::System(system), [](const model::System* copy) {
            const SymbolicLock held;
            delete copy;
          }};
}

Expected<Integrand> Integrand::make(const model::System& system, const SimulateOptions& options) {
  if (options.method != Method::smoothed) return Integrand(system);
  const SymbolicLock lock;
  return smoothed::regularise(system, options.smoothed.epsilon).map([](auto regularisation) {
    const auto drop = [](const smoothed::Regularisation* made) {
      const SymbolicLock held;
      delete made;
    };
    return Integrand(
        std::shared_ptr<const smoothed::Regularisation>(new smoothed::Regularisation(std::move(regularisation)), drop));
  });
}

Integrand::Integrand(std::shared_ptr<const smoothed::Regularisation> regularisation)
    : system_(&regularisation->system), regularisation_(std::move(regularisation)) {}

std::size_t Integrand::selections() const {
  if (!regularisation_) return 0;
  std::size_t count = regularisation_->columns.size();
  for (const auto& group : regularisation_->regions) count += group.names.size();
  return count;
}

event_integrator::ThinLayers Integrand::layers() const {
  event_integrator::ThinLayers layers;
  if (!regularisation_) return layers;
  layers.half_width = regularisation_->epsilon;
  const auto function = [&](std::size_t column) { return regularisation_->system.columns[column].function; };
  for (const auto& layer : regularisation_->layers) {
    for (const auto& side : layer.sides) {
      if (side.lower != side.upper) layers.corners.push_back({function(side.lower), function(side.upper)});
    }
  }
  for (const auto& regions : regularisation_->regions) {
    for (const std::size_t column : regions.columns) layers.weights.push_back(function(column));
  }
  layers.weight_range = smoothed::weight_range * regularisation_->epsilon;
  return layers;
}

event_integrator::Integration Integrand::restated(event_integrator::Integration run) const {
  if (!regularisation_) return run;
  run.branch_points.clear();  // the regularised system has one solution
  run.families.clear();
  smoothed::restate(*regularisation_, run.events, run.trajectory, run.status);
  const auto& rows = run.trajectory;
  run.final.mode = rows.mode.back();
  run.final.alpha = rows.alpha.back();
  run.final.outputs = rows.outputs.back();
  if (!rows.regions.empty()) {
    run.final.regions = rows.regions.back();
    run.final.theta = rows.theta.back();
  }
  return run;
}

result::Trajectory Integrand::restated(result::Trajectory rows) const {
  if (!regularisation_ || rows.t.empty()) return rows;
  result::Events none;
  result::Status status;
  smoothed::restate(*regularisation_, none, rows, status);
  return rows;
}

}  // namespace saltus::pipeline
