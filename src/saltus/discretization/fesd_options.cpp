#include "saltus/discretization/fesd_options.hpp"

namespace saltus::discretization {

std::string_view name(Representation representation) {
  return representation == Representation::integral ? "integral" : "differential";
}

std::string_view name(CrossComplementarity cross_complementarity) {
  switch (cross_complementarity) {
    case CrossComplementarity::stage_stage:
      return "stage_stage";
    case CrossComplementarity::fe_stage:
      return "fe_stage";
    case CrossComplementarity::stage_fe:
      return "stage_fe";
    case CrossComplementarity::fe_fe:
      return "fe_fe";
    case CrossComplementarity::paper:
      return "paper";
    case CrossComplementarity::same_stage:
      return "same_stage";
  }
  return {};
}

std::string_view name(StepEquilibration step_equilibration) {
  switch (step_equilibration) {
    case StepEquilibration::none:
      return "none";
    case StepEquilibration::heuristic_mean:
      return "heuristic_mean";
    case StepEquilibration::heuristic_diff:
      return "heuristic_diff";
    case StepEquilibration::l2_relaxed:
      return "l2_relaxed";
    case StepEquilibration::l2_relaxed_scaled:
      return "l2_relaxed_scaled";
    case StepEquilibration::direct:
      return "direct";
    case StepEquilibration::mlcp:
      return "mlcp";
    case StepEquilibration::paper:
      return "paper";
  }
  return {};
}

}  // namespace saltus::discretization
