#include "saltus/event_integrator/mode/mode_state.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

void set_surface(ModeState& state, int surface, int mode, double alpha) {
  const auto j = static_cast<std::size_t>(surface);
  state.mode[j] = mode;
  state.alpha[j] = alpha;
  auto& sliding = state.sliding;
  const auto place = std::lower_bound(sliding.begin(), sliding.end(), surface);
  const bool listed = place != sliding.end() && *place == surface;
  if (mode == 0 && !listed) sliding.insert(place, surface);
  if (mode != 0 && listed) sliding.erase(place);
}

void set_to_corner(ModeState& state, const std::vector<int>& surfaces, std::size_t corner) {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const bool above = (corner >> i & 1U) != 0;
    set_surface(state, surfaces[i], above ? 1 : -1, above ? 1.0 : 0.0);
  }
}

void set_corner_alpha(ModeState& state) {
  if (state.sliding.empty()) return;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    auto& alpha = state.corner_alpha[corner];
    alpha = state.alpha;
    for (const int j : state.sliding) alpha[at(j)] = 0.0;
    alpha[at(state.sliding.front())] = static_cast<double>(corner);
  }
}

}  // namespace saltus::event_integrator
