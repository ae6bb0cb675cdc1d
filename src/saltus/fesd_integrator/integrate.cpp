#include "saltus/fesd_integrator/integrate.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"
#include "saltus/fesd_integrator/solution.hpp"
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
  auto kernel = discretization::StageKernel::compile(dcs, system.parameter_values, options.native);
  if (!kernel) return tl::unexpected(kernel.error());
  auto functions = discretization::PointFunctions::compile(dcs, system.parameter_values, options.native);
  if (!functions) return tl::unexpected(functions.error());
  const Facts known = facts(system, dcs);
  std::vector<ElementPiece> pieces;
  const auto evaluated = [&](SensitivityPropagation* propagation) {
    Run run(*kernel, *functions, known, options, observer, propagation);
    const SymbolicPause pause;
    auto integration = run.run();
    pieces = run.take_pieces();
    return integration;
  };
  const auto with_solution = [&](Integration integration) {
    if (!options.pieces) return integration;
    IntegrationOptions alone = options;
    alone.step_problem = nullptr;
    alone.fallback = {};
    integration.solution =
        std::make_shared<Solution>(std::move(*kernel), std::move(*functions), known, alone, std::move(pieces));
    return integration;
  };
  if (!options.sensitivities) return with_solution(evaluated(nullptr));
  if (!dcs.root_exponents.empty()) return tl::unexpected(no_derivatives());
  const auto tangent = discretization::TangentKernel::compile(dcs, system.parameter_values, options.native);
  if (!tangent) return tl::unexpected(tangent.error());
  SensitivityPropagation propagation(*tangent, options.tableau);
  auto integration = evaluated(&propagation);
  if (integration.status.termination == result::Termination::completed) {
    integration.sensitivities = propagation.sensitivities(system.parameter_names);
  }
  return with_solution(std::move(integration));
}

}  // namespace saltus::fesd_integrator
