#include "saltus/fesd_integrator/integrate.hpp"

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"
#include "saltus/model/system.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

Error no_derivatives() {
  return {
      ErrorCode::not_available,
      "sensitivities do not cover roots of what is zero on a surface (sqrt(abs(x))): the equations of elements have "
      "infinite derivatives there",
      "leave simulate.fesd.sensitivities out",
      {},
      {}};
}

}  // namespace

Expected<Integration> integrate(const model::System& system, const reformulation::Dcs& dcs,
                                const IntegrationOptions& options, const StepObserver& observer) {
  const auto kernel = discretization::StageKernel::compile(dcs, system.parameter_values, options.native);
  if (!kernel) return tl::unexpected(kernel.error());
  const auto functions = discretization::PointFunctions::compile(dcs, system.parameter_values, options.native);
  if (!functions) return tl::unexpected(functions.error());
  const Facts known = facts(system, dcs);
  const auto evaluated = [&](SensitivityPropagation* propagation) {
    Run run(*kernel, *functions, known, options, observer, propagation);
    const SymbolicPause pause;
    return run.run();
  };
  if (!options.sensitivities) return evaluated(nullptr);
  if (!dcs.root_exponents.empty()) return tl::unexpected(no_derivatives());
  const auto tangent = discretization::TangentKernel::compile(dcs, system.parameter_values, options.native);
  if (!tangent) return tl::unexpected(tangent.error());
  SensitivityPropagation propagation(*tangent, options.tableau);
  auto integration = evaluated(&propagation);
  if (integration.status.termination == result::Termination::completed) {
    integration.sensitivities = propagation.sensitivities(system.parameter_names);
  }
  return integration;
}

}  // namespace saltus::fesd_integrator
