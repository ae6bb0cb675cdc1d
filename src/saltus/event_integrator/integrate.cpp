#include "saltus/event_integrator/integrate.hpp"

#include <utility>

#include "saltus/event_integrator/contact/contact_results.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

CompactIntegration integrate_compact(evaluation::ModelKernel& kernel, const model::System& system,
                                     const IntegrationOptions& options, const StepObserver& observer) {
  return Run(kernel, system, options).to_end(observer);
}

Integration integrate(evaluation::ModelKernel& kernel, const model::System& system,
                      const IntegrationOptions& options, const StepObserver& observer) {
  CompactIntegration run = integrate_compact(kernel, system, options, observer);
  auto& recording = run.recording;
  Integration integration{std::move(run.status),
                          recording.last(system),
                          recording.events(system),
                          recording.trajectory(system),
                          run.statistics,
                          std::move(recording.branch_points),
                          run.chosen,
                          recording.listed_families(system),
                          recording.family_numbers()};
  if (!system.contacts.empty()) {
    show_contacts(system, integration.final, integration.events, integration.trajectory);
  }
  return integration;
}

}  // namespace saltus::event_integrator
