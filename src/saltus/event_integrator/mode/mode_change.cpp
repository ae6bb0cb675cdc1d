#include "saltus/event_integrator/mode/mode_change.hpp"

#include "saltus/base/at.hpp"

namespace saltus::event_integrator {

void apply(const ModeChange& change, ModeState& state) {
  if (!change.is_single()) {
    state = *change.mode_after;
    return;
  }
  set_surface(state, change.surface, change.after, change.alpha_after);
  if (change.slid != nullptr) state.alpha[at(change.slid->surface)] = change.slid->alpha_after;
  set_corner_alpha(state);
}

}  // namespace saltus::event_integrator
