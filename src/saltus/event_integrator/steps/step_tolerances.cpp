#include "saltus/event_integrator/steps/step_tolerances.hpp"

#include <algorithm>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/steps/thin_layers.hpp"

namespace saltus::event_integrator {
namespace {

/// The local error of a step is kept to a tenth of the tolerance. So the error of the whole run is about the tolerance,
/// and shallow dips of a switching function are seen at loose tolerances, too. Evidence is the relay with 401
/// tolerances from 1e-3 to 1e-12: dopri5 finds all events at each, dop853 at 395 (without the factor 388 and 367). The
/// error is not kept below what doubles carry.
ode::Tolerances local_tolerances(const ode::Tolerances& wanted) {
  constexpr double share = 0.1;
  return {std::max(share * wanted.rtol, std::min(wanted.rtol, 4.0 * rounding_unit)), share * wanted.atol};
}

}  // namespace

StepTolerances::StepTolerances(const ode::Tolerances& wanted)
    : wanted_(local_tolerances(wanted)), mode_(wanted_), step_(wanted_) {}

void StepTolerances::begin_mode(const evaluation::ModelKernel& kernel, const ThinLayers& layers, const Position& here) {
  if (!layers.empty()) mode_ = within_layers(kernel, layers, wanted_, here.state, here.t, here.x.data());
  lift(Reason::coalescence);
}

void StepTolerances::limit(Reason reason, const ode::Tolerances& parts) {
  parts_[static_cast<std::size_t>(reason)] = parts;
  step_ = mode_;
  for (const auto& part : parts_) {
    step_.rtol *= part.rtol;
    step_.atol *= part.atol;
  }
}

}  // namespace saltus::event_integrator
