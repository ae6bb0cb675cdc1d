#include "saltus/fesd_integrator/integrate.hpp"

#include "saltus/fesd_integrator/run_internal.hpp"
#include "saltus/model/system.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {

Expected<Integration> integrate(const model::System& system, const reformulation::Dcs& dcs,
                                const IntegrationOptions& options, const StepObserver& observer) {
  const auto kernel = discretization::StageKernel::compile(dcs, system.parameter_values);
  if (!kernel) return tl::unexpected(kernel.error());
  const auto functions = discretization::PointFunctions::compile(dcs, system.parameter_values);
  if (!functions) return tl::unexpected(functions.error());
  if (functions->event_functions() > 0) {
    return tl::unexpected(Error{ErrorCode::not_available,
                                "[[events]] are not available with finite elements in this version",
                                "use method = \"event\"",
                                {},
                                {}});
  }
  const Facts known = facts(system, dcs);
  return Run(*kernel, *functions, known, options, observer).run();
}

}  // namespace saltus::fesd_integrator
