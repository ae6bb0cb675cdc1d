// Contacts as a result shows them.
#pragma once

#include <span>
#include <vector>

#include "saltus/model/layout.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// Returns the modes of contacts in these states (Recording::contact_states).
[[nodiscard]] std::vector<result::ContactMode> contact_modes(std::span<const int> states);

/// Gives an event the modes of contacts on both sides. A jump of contacts becomes an impact, a contact, a lift-off, a
/// stick or a slip; false where it changes nothing.
/// @param impulses  Contacts::impulses()
[[nodiscard]] bool tell_contacts(const model::Layout& layout, std::span<const int> before, std::span<const int> after,
                                 std::span<const double> impulses, result::Event& event);

/// Takes the last event, which changes nothing, into the one before it at the same time: several contacts may end at
/// once, and the first of their jumps has changed all.
void take_into_previous(result::Events& events);

/// Writes the impulses of events into the outputs that have their names, in the rows behind them.
void write_impulses(const model::Layout& layout, const result::Events& events, result::Trajectory& trajectory);

}  // namespace saltus::event_integrator
