// Limits of sequences of events: what holds there before the mode behind is decided, and their record.
#pragma once

#include <string_view>
#include <vector>

#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Puts the guards that accumulating jumps leave at 0 to rest there, or lets the motion go on where the jumps change
/// nothing. The state is at the limit. Returns false where the run ends.
bool rest_at_limit(const InstantContext& c, const Instant& instant);
/// Moves to the limit of bounces, where gaps close, with the rows on the way. Returns false where the run ends.
/// @param before_last  the mode before the last bounce
bool settle_contacts(const InstantContext& c, const SeriesLimit& limit, const ModeState& before_last);
/// Records the limit of jumps, with a row.
void record_limit_of_jumps(const InstantContext& c, const std::vector<int>& jumps, std::string_view why);
/// Records the limit of switches, with a row.
void record_limit_of_switches(const InstantContext& c, const Instant& instant);

}  // namespace saltus::event_integrator
