#include "saltus/event_integrator/instant/mass_beyond.hpp"

#include <vector>

#include <fmt/format.h>

#include "saltus/evaluation/explanations.hpp"

namespace saltus::event_integrator {

std::optional<std::string> indefinite_mass_beyond(const RunState& run) {
  const Position& here = run.here;
  std::vector<double> x = here.x;
  for (double h = here.smallest_step(); h <= 1e6 * here.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = here.x[i] + h * here.slope[i];
    const auto row = evaluation::find_indefinite_mass(run.kernel, x);
    if (!row) continue;
    return fmt::format(
        "the mass matrix is not positive definite beyond {}: {}; every velocity needs a positive mass or inertia "
        "wherever the bodies get",
        run.where(), *row);
  }
  return std::nullopt;
}

}  // namespace saltus::event_integrator
