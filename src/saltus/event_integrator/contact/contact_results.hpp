// Contacts as a result shows them.
#pragma once

#include <vector>

#include "saltus/model/layout.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// Takes the discrete states that say the modes of contacts out of rows and events of a run; rows get `contact_modes`,
/// and jumps of contacts become impacts, contacts, lift-offs, sticks and slips. Those that change nothing go.
void show_contacts(const model::Layout& layout, result::Final& final, result::Events& events,
                   result::Trajectory& trajectory);

/// Does this for rows.
void show_contacts(const model::Layout& layout, result::Trajectory& trajectory);

}  // namespace saltus::event_integrator
