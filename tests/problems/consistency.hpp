// Whether the event list of a result can be the history of one solution.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::problems {

/// A flip back: a mode returns within `instant` to what it just was. The fields of the catalogue are of order one to a
/// thousand: a real return takes longer than that.
inline constexpr double instant = 1e-9;

/// What is wrong with the events of a result, or with its end; empty if nothing is: every event starts from the mode
/// that the one before left behind, times do not decrease, no surface is met twice at one time, nothing flips back.
[[nodiscard]] std::string complaint(const result::Result& result);

}  // namespace saltus::problems
