// Signs of functions of the user at an instant: guards of jumps, and expressions and conditions of [[events]].
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Lets user functions that were located continue with the other sign.
void flip_user_functions(const InstantContext& c, const Located& located);

/// Turns what was located, but passes nothing, as the mode behind keeps it at zero, or leads it back. Conditions that
/// compare what is slid on from here are at equality. A function with a kink at its zero takes the side of the mode
/// behind. That mode is decided and not entered.
void turn_by_mode_behind(const InstantContext& c, const Located& located);

/// Fires the events of the user that the signs here say; returns them. One that stops the run ends it.
/// @param before_jumps  what has fired before the jumps of this time: a zero that they leave at once on the side that
///                      it was reached from is no second one
std::vector<std::size_t> fire_user_events(const InstantContext& c, const std::vector<double>& x_before,
                                          const ModeState& before, const std::vector<std::size_t>& before_jumps = {});

}  // namespace saltus::event_integrator
