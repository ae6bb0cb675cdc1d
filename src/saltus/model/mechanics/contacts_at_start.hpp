// Whether bodies begin apart or in touch, and tangents lie along their surfaces.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::model {

struct System;

/// Refuses the gap of a contact that is negative at the start, by more than its rounding, or no number.
/// @param when  behind "at the start"
[[nodiscard]] std::optional<Error> check_gap_at_start(const std::string& contact, double gap,
                                                      const std::string& when = {});

/// Refuses tangents of a contact that are 0 or along the normal at the start, and two that do not span a plane.
/// @param rows  the normal, then one or two tangents, over the positions
/// @param when  behind "at the start"
[[nodiscard]] std::optional<Error> check_tangents_at_start(const std::string& contact,
                                                           const std::vector<std::vector<double>>& rows,
                                                           const std::string& when = {});

/// Refuses a system of which a gap or a tangent depends on t and is wrong at the start, at time `from`: build() refuses
/// the others, and does not know that time.
[[nodiscard]] std::optional<Error> check_contacts_at_start(const System& system, double from);

}  // namespace saltus::model
