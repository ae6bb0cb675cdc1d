#include "saltus/event_integrator/thin_layers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "saltus/event_integrator/small_internal.hpp"

namespace saltus::event_integrator {

ode::Tolerances within_layers(const evaluation::ModelKernel& kernel, const ThinLayers& layers,
                              const ode::Tolerances& wanted, const ModeState& state, double t, const double* x) {
  // The relay of the catalogue, at epsilon from 1e-5 to 1e-9 and rtol from 1e-5 to 1e-10: a tenth of this is as good,
  // five times this misses sliding segments at the thin end.
  constexpr double share = 1e-4;
  ode::Tolerances result = wanted;
  std::vector<double> row(at(kernel.states())), values(at(kernel.event_functions()));
  kernel.functions(t, x, state.alpha.data(), values.data());
  for (const auto& layer : layers.corners) {
    const double psi = 0.5 * (values[at(layer.lower)] + values[at(layer.upper)]);
    if (!(std::abs(psi) <= 2.0 * layers.half_width)) continue;
    double rate = 0.0;
    kernel.gradient(layer.lower, t, x, state.alpha.data(), row.data(), &rate);
    double slope = 0.0, size = 0.0;
    for (std::size_t i = 0; i < row.size(); ++i) {
      slope += std::abs(row[i]);
      size += std::abs(row[i] * x[i]);
    }
    if (slope > 0.0 && std::isfinite(slope)) result.atol = std::min(result.atol, share * layers.half_width / slope);
    if (size > 0.0 && std::isfinite(size)) result.rtol = std::min(result.rtol, share * layers.half_width / size);
  }
  result.rtol = std::max(result.rtol, std::min(wanted.rtol, 4.0 * rounding_unit));
  return result;
}

}  // namespace saltus::event_integrator
