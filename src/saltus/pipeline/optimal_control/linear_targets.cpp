#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/linear_targets_internal.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;

/// The only state of an expression that is affine in it, with coefficients of parameters.
std::optional<std::size_t> single_linear_state(const model::Ocp& ocp, const SX& expression) {
  const auto& system = ocp.system;
  const auto depends = [](const SX& e, const SX& on) { return on.numel() > 0 && SX::depends_on(e, on); };
  if (depends(expression, system.t) || depends(expression, system.u) || depends(expression, system.alpha)) return {};
  for (const auto& cell : system.cells) {
    if (depends(expression, cell.symbols)) return {};
  }
  for (const auto& initial : ocp.initial_values) {  // a periodic solution does not stay where it begins
    if (ocp.free_states[at(initial.state)] && depends(expression, system.p(initial.parameter))) return {};
  }
  std::optional<std::size_t> found;
  for (casadi_int i = 0; i < system.x.numel(); ++i) {
    const SX state = system.x(i);
    if (!depends(expression, state)) continue;
    if (found || depends(SX::jacobian(expression, state), state)) return {};
    found = at(i);
  }
  return found;
}

}  // namespace

Expected<std::vector<std::optional<double>>> linear_targets(const model::Ocp& ocp,
                                                            const std::vector<double>& parameters,
                                                            PointValues& values) {
  const std::size_t n = ocp.system.initial_state.size();
  std::vector<std::optional<double>> targets(n);
  ModelPoint point{ocp.from + ocp.horizon.value, std::vector<double>(n), ocp.system.control_initial, parameters};
  for (const auto& constraint : ocp.terminal) {
    if (constraint.norm != model::ConstraintNorm::hard || constraint.lower != constraint.upper) continue;
    std::optional<std::size_t> state;
    try {
      state = single_linear_state(ocp, ocp.system.outputs(constraint.output));
    } catch (const std::exception& exception) {
      return tl::unexpected(Error{ErrorCode::invalid_model,
                                  fmt::format("CasADi refused '{}': {}", constraint.name, exception.what()),
                                  "",
                                  {},
                                  {}});
    }
    if (!state) continue;
    point.x.assign(n, 0.0);
    const double at_zero = values.outputs(point)[at(constraint.output)];
    point.x[*state] = 1.0;
    const double slope = values.outputs(point)[at(constraint.output)] - at_zero;
    const double target = (constraint.lower - at_zero) / slope;
    if (std::isfinite(target)) targets[*state] = target;
  }
  return targets;
}

}  // namespace saltus::pipeline
