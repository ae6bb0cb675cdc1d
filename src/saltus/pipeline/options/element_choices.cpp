#include "saltus/pipeline/options/element_choices_internal.hpp"

namespace saltus::pipeline {

reformulation::ReformulationOptions reformulation_options(const ElementOptions& options) {
  reformulation::ReformulationOptions wanted;
  wanted.reformulation =
      options.reformulation == Reformulation::step ? reformulation::Form::step : reformulation::Form::stewart;
  wanted.lifting.reset();
  if (options.lifting) wanted.lifting = static_cast<int>(*options.lifting);
  return wanted;
}

discretization::FesdOptions fesd_options(const ElementOptions& wanted) {
  return {.representation = wanted.representation,
          .cross_complementarity = wanted.cross_complementarity,
          .step_equilibration = wanted.step_equilibration,
          .gamma_h = wanted.step_bounds,
          .rho_h = wanted.rho,
          .sigma_h = wanted.equilibration_scale};
}

evaluation::NativeCode native_code(Native native) {
  switch (native) {
    case Native::automatic:
      return evaluation::NativeCode::automatic;
    case Native::on:
      return evaluation::NativeCode::on;
    case Native::off:
      return evaluation::NativeCode::off;
  }
  __builtin_unreachable();
}

}  // namespace saltus::pipeline
