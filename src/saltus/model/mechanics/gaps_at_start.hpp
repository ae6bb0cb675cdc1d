// Whether bodies begin apart or in touch.
#pragma once

#include <optional>
#include <string>

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Refuses the gap of a contact that is negative at the start, by more than its rounding.
/// @param when  behind "at the start"
[[nodiscard]] std::optional<Error> check_gap_at_start(const std::string& contact, double gap,
                                                      const std::string& when = {});

/// Refuses a system of which a gap depends on t and is negative at the start, at time `from`: build() refuses the
/// others, and does not know that time.
[[nodiscard]] std::optional<Error> check_gaps_at_start(const System& system, double from);

}  // namespace saltus::model
