#include "saltus/event_integrator/mode/undefined.hpp"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace saltus::event_integrator {

std::string undefined_states(const model::Layout& layout, const std::vector<double>& values) {
  constexpr std::size_t most = 3;
  std::string text;
  std::size_t found = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    if (++found > most) continue;
    // The sign of a NaN says nothing.
    text += fmt::format("{}'{}' ({})", found == 1 ? "" : ", ", layout.state_names[i],
                        std::isnan(values[i]) ? "nan" : fmt::format("{}", values[i]));
  }
  return found > most ? fmt::format("{} and {} more", text, found - most) : text;
}

}  // namespace saltus::event_integrator
