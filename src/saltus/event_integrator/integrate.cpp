#include "saltus/event_integrator/integrate.hpp"

#include <utility>

#include "saltus/event_integrator/contact/contact_results.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

namespace {

/// The method to begin with, where none is named.
IntegrationOptions with_first_method(const evaluation::ModelKernel& kernel, IntegrationOptions options) {
  if (options.chooses_method) options.method = first_method(at(kernel.states()), options.tolerances);
  return options;
}

}  // namespace

CompactIntegration integrate_compact(evaluation::ModelKernel& kernel, const IntegrationOptions& options,
                                     const StepObserver& observer) {
  const IntegrationOptions asked = with_first_method(kernel, options);
  return Run(kernel, asked).to_end(observer);
}

namespace {

/// Rows and events of a part of a run.
void expand(const model::Layout& layout, Recording recording, Integration& integration) {
  integration.final = recording.last(layout);
  integration.events = recording.events(layout);
  integration.trajectory = std::move(recording).trajectory(layout);
  if (layout.contacts.empty()) return;
  write_impulses(layout, integration.events, integration.trajectory);
  const auto outputs = integration.trajectory.outputs.back();
  integration.final.outputs = {outputs.begin(), outputs.end()};
}

}  // namespace

Integration integrate(evaluation::ModelKernel& kernel, const IntegrationOptions& options, const StepObserver& observer,
                      const TakeRecorded& take) {
  Integration integration;
  const auto pass_on = [&](Recording recording) {
    if (recording.row_times.empty()) return;
    expand(kernel.layout(), std::move(recording), integration);
    if (!take) return;
    take(std::move(integration.trajectory), std::move(integration.events));
    integration.trajectory = {};
    integration.events = {};
  };
  const IntegrationOptions asked = with_first_method(kernel, options);
  CompactIntegration run = Run(kernel, asked).to_end(observer, take ? TakeRecording(pass_on) : nullptr);
  auto& recording = run.recording;
  integration.status = std::move(run.status);
  integration.statistics = run.statistics;
  integration.chosen = run.chosen;
  integration.pieces = std::move(run.pieces);
  integration.families = recording.listed_families(kernel.layout());
  integration.family_numbers = recording.family_numbers();
  if (!take) integration.branch_points = std::move(recording.branch_points);
  pass_on(std::move(recording));
  return integration;
}

}  // namespace saltus::event_integrator
