// What comes of a random system in one line, to be compared with what came of it before a change.
#pragma once

#include <cstdint>
#include <string>

#include "hybrid_systems.hpp"
#include "random_systems.hpp"
#include "saltus/result/result.hpp"

namespace saltus::robustness {

/// The head of a file of outcomes: names of its columns.
[[nodiscard]] std::string outcome_columns();

/// A line without its end: seed, status, number of events, events by kind ("crossing:3;jump:2"), hash of kinds, names
/// and surfaces of the events (16 bits), sum of event times, sum of i x_i of the end state (i from 1), end state.
/// Numbers are rounded to 7 significant digits, those below 1 to 7 decimals.
[[nodiscard]] std::string outcome_line(std::uint64_t seed, const result::Result& result);

/// What comes of a system at rtol 1e-8, with dopri5, dop853 and taylor in turn, by its seed. No check is made. A system
/// that the builder refuses has the status "refused", one with two surfaces that are one "equal_surfaces".
[[nodiscard]] std::string outcome_of(Family family, std::uint64_t seed);
[[nodiscard]] std::string outcome_of(HybridFamily family, std::uint64_t seed);
[[nodiscard]] std::string outcome_of_regions(std::uint64_t seed);

}  // namespace saltus::robustness
