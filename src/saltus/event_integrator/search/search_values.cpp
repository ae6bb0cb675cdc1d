#include "saltus/event_integrator/search/search_values.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

void FunctionLevels::reset(std::size_t functions) {
  noise.assign(functions, 0.0);
  accuracy.assign(functions, 0.0);
}

void FunctionLevels::set(std::size_t function, double rounding, double wanted) {
  noise[function] = std::isfinite(rounding) ? rounding : 0.0;
  accuracy[function] = std::isfinite(wanted) ? std::max(wanted, noise[function]) : 0.0;
}

void StepRange::resize(std::size_t states) {
  for (auto* vector : {&low, &high, &wide_low, &wide_high}) vector->resize(states);
}

bool StepRange::read(const ode::Stepper& stepper) {
  if (!stepper.bounds(low.data(), high.data())) return false;
  bounds = {stepper.start_time(), stepper.start_time() + stepper.length(), low.data(), high.data()};
  // What DenseStep::bounds says, bit for bit; of dop853 they are others.
  known = stepper.method() == ode::Method::taylor || stepper.method() == ode::Method::dopri5;
  return true;
}

void StepRange::read(const ode::DenseStep& step) {
  bounds = {step.t, step.t + step.h, low.data(), high.data()};
  if (!std::exchange(known, false)) step.bounds(low.data(), high.data());
}

StepBounds StepRange::widened(const ode::Tolerances& tolerances) {
  for (std::size_t i = 0; i < low.size(); ++i) {
    const double size = std::max(std::abs(low[i]), std::abs(high[i]));
    const double room = high[i] - low[i] + 1e3 * (tolerances.atol + tolerances.rtol * size);
    wide_low[i] = low[i] - room;
    wide_high[i] = high[i] + room;
  }
  const double length = bounds.end - bounds.begin;
  return {bounds.begin - length, bounds.end + length, wide_low.data(), wide_high.data()};
}

}  // namespace saltus::event_integrator
