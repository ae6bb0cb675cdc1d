// What the stages of an instant share.
#pragma once

#include "saltus/event_integrator/instant/instant.hpp"
#include "saltus/event_integrator/instant/jump_cascade.hpp"
#include "saltus/event_integrator/instant/run_state.hpp"

namespace saltus::event_integrator {

/// InstantContext holds the state of the run, what is known of its functions at this time, and what has happened.
struct InstantContext {
  RunState& run;
  JumpCascade& cascade;
  Outcome& out;

  [[nodiscard]] JumpPoint jump_point() const { return cascade.jump_point(); }
};

}  // namespace saltus::event_integrator
