#include "saltus/event_integrator/mode/selections_at.hpp"

#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {

std::vector<double> selections_at(const evaluation::ModelKernel& kernel, double t, const double* x,
                                  std::vector<double> alpha, const std::vector<int>& zeros) {
  const auto n = at(kernel.event_functions());
  std::vector<double> values(n), noise(n), slope(n);
  kernel.scales(t, x, alpha.data(), noise.data(), slope.data());
  kernel.functions(t, x, alpha.data(), values.data());
  for (int j = 0; j < kernel.switching_functions(); ++j) {
    const auto& function = kernel.layout().surfaces[at(j)];
    if (function.role == model::SwitchingRole::region) continue;
    if (!kernel.inner(j).empty()) kernel.functions(t, x, alpha.data(), values.data());
    const double psi = values[at(j)];
    const bool discrete = function.role == model::SwitchingRole::discrete;
    if (discrete && psi == 0.0) alpha[at(j)] = function.alpha_at_zero;
    if (!discrete && contains(zeros, j)) continue;
    if (std::abs(psi) > (discrete ? 0.0 : rounding_of(noise[at(j)]))) alpha[at(j)] = psi > 0.0 ? 1.0 : 0.0;
  }
  return alpha;
}

}  // namespace saltus::event_integrator
