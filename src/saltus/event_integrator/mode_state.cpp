#include "saltus/event_integrator/mode_state.hpp"

#include <algorithm>

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

}  // namespace saltus::event_integrator
