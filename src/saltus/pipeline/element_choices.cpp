#include "saltus/pipeline/element_choices_internal.hpp"

namespace saltus::pipeline {

discretization::TableauFamily family(Scheme scheme) {
  switch (scheme) {
    case Scheme::radau_iia:
      return discretization::TableauFamily::radau_iia;
    case Scheme::gauss_legendre:
      return discretization::TableauFamily::gauss_legendre;
    case Scheme::lobatto_iiia:
      return discretization::TableauFamily::lobatto_iiia;
    case Scheme::lobatto_iiic:
      return discretization::TableauFamily::lobatto_iiic;
    case Scheme::explicit_rk:
      return discretization::TableauFamily::explicit_rk;
  }
  __builtin_unreachable();
}

reformulation::ReformulationOptions reformulation_options(const ElementOptions& options) {
  reformulation::ReformulationOptions wanted;
  wanted.reformulation =
      options.reformulation == Reformulation::step ? reformulation::Form::step : reformulation::Form::stewart;
  wanted.lifting.reset();
  if (options.lifting) wanted.lifting = static_cast<int>(*options.lifting);
  return wanted;
}

namespace {

discretization::StepEquilibration equilibration(StepEquilibration wanted) {
  switch (wanted) {
    case StepEquilibration::none:
      return discretization::StepEquilibration::none;
    case StepEquilibration::heuristic_mean:
      return discretization::StepEquilibration::heuristic_mean;
    case StepEquilibration::heuristic_diff:
      return discretization::StepEquilibration::heuristic_diff;
    case StepEquilibration::l2_relaxed:
      return discretization::StepEquilibration::l2_relaxed;
    case StepEquilibration::l2_relaxed_scaled:
      return discretization::StepEquilibration::l2_relaxed_scaled;
    case StepEquilibration::direct:
      return discretization::StepEquilibration::direct;
    case StepEquilibration::mlcp:
      return discretization::StepEquilibration::mlcp;
    case StepEquilibration::paper:
      return discretization::StepEquilibration::paper;
  }
  __builtin_unreachable();
}

discretization::CrossComplementarity cross(CrossComplementarity wanted) {
  switch (wanted) {
    case CrossComplementarity::stage_stage:
      return discretization::CrossComplementarity::stage_stage;
    case CrossComplementarity::fe_stage:
      return discretization::CrossComplementarity::fe_stage;
    case CrossComplementarity::stage_fe:
      return discretization::CrossComplementarity::stage_fe;
    case CrossComplementarity::fe_fe:
      return discretization::CrossComplementarity::fe_fe;
    case CrossComplementarity::paper:
      return discretization::CrossComplementarity::paper;
  }
  __builtin_unreachable();
}

}  // namespace

discretization::FesdOptions fesd_options(const ElementOptions& wanted) {
  return {.representation = wanted.representation == Representation::integral
                                ? discretization::Representation::integral
                                : discretization::Representation::differential,
          .cross_complementarity = cross(wanted.cross_complementarity),
          .step_equilibration = equilibration(wanted.step_equilibration),
          .gamma_h = wanted.step_bounds,
          .rho_h = wanted.rho,
          .sigma_h = wanted.equilibration_scale};
}

}  // namespace saltus::pipeline
