#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/time_freezing/physical_path_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"

namespace saltus::pipeline {

model::Ocp physical_ocp(const model::Ocp& ocp) {
  model::Ocp judged = ocp;
  judged.system = *ocp.physical;
  judged.clock.reset();
  return judged;
}

Expected<std::unique_ptr<PhysicalBodies>> PhysicalBodies::make(const model::Ocp& ocp,
                                                               const std::vector<double>& parameters) {
  model::System system = *ocp.physical;
  system.parameter_values.assign(parameters.begin(), parameters.begin() + index(system.parameter_names.size()));
  auto kernel = evaluation::ModelKernel::compile(system);
  if (!kernel) return tl::unexpected(kernel.error());
  return std::unique_ptr<PhysicalBodies>(new PhysicalBodies(std::move(system), std::move(*kernel)));
}

void add_impulses(PhysicalBodies& bodies, result::Result& run) {
  const auto& system = bodies.system();
  result::Events events;
  for (result::Event event : run.events) {
    if (event.kind == result::EventKind::impact) {
      event.impulse = bodies.touching().impulses(event.t, event.x, event.x_after);
      double largest = 0.0;
      for (const auto& one : *event.impulse) largest = std::max(largest, std::abs(one.front()));
      event.surfaces.clear();
      for (std::size_t i = 0; i < event.impulse->size(); ++i) {
        if (std::abs((*event.impulse)[i].front()) > 1e-6 * largest)
          event.surfaces.push_back(system.contacts.contacts[i].name);
      }
    }
    events.push_back(std::move(event));
  }
  run.events = std::move(events);
}

OptimizedPath physical_path(const model::Ocp& ocp, PhysicalBodies& bodies, const OptimizedPath& path,
                            const result::Result& run) {
  const auto& system = bodies.system();
  OptimizedPath physical = path;
  physical.parameters = system.parameter_values;
  const std::size_t intervals = path.controls.size();
  const auto& rows = run.trajectory;
  for (std::size_t k = 0; k <= intervals; ++k) {
    const double share = k == intervals ? 1.0 : static_cast<double>(k) / static_cast<double>(intervals);
    const double t = ocp.from + path.horizon * share;
    // Time may stand still at a node: there are two rows then.
    const double rounding = 1e-9 * path.horizon;
    const auto first = std::lower_bound(rows.t.begin(), rows.t.end(), t - rounding) - rows.t.begin();
    const auto behind = std::upper_bound(rows.t.begin(), rows.t.end(), t + rounding) - rows.t.begin();
    const auto row = at(std::max<std::ptrdiff_t>(behind, 1) - 1);
    std::vector<double> node = rows.x[row], end = rows.x[std::min(at(first), row)];
    if (k < intervals && !rows.contact_modes.empty()) bodies.touching().project(t, rows.contact_modes[row], node);
    if (k > 0) physical.ends.push_back(std::move(end));
    physical.times[k] = t;
    physical.nodes[k] = std::move(node);
  }
  for (auto& start : physical.elements) {
    start.t = start.x[at(ocp.system.freezing->clock)];
    start.x = shown_states(*ocp.system.freezing, start.x);
  }
  for (auto* range : {&physical.state_max, &physical.state_min}) range->resize(system.state_names.size());
  physical.events = run.events;
  // Modes of a result are those of functions that freezing has left.
  for (auto& event : physical.events) {
    if (event.mode_before && event.mode_before->size() != system.columns.size()) event.mode_before.reset();
    if (event.mode_after && event.mode_after->size() != system.columns.size()) event.mode_after.reset();
  }
  return physical;
}

}  // namespace saltus::pipeline
