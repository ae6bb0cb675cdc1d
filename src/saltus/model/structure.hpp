// What of a system its compiled functions are made of.
#pragma once

#include <cstdint>
#include <vector>

namespace saltus::model {

struct System;

/// Returns the operations of all expressions that a simulation compiles, in their order, with their constants, with
/// symbols by their places; values of parameters and initial states are not in it. Two systems with the same structure
/// have the same compiled functions, bit by bit. Cost: one look at every operation, table and jump.
[[nodiscard]] std::vector<std::uint64_t> structure(const System& system);

}  // namespace saltus::model
