// What `saltus check` says about a model as a dynamic complementarity system.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saltus/io/check/model_overview.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::frontend {

/// Switching functions up to which a check makes the complementarity systems: their cost grows faster than the model.
inline constexpr std::size_t most_reformulated = 100;

/// Returns the sizes of Table 4 of [nurkanovic2024] for every form, in total and per group, or why there is none:
/// of more than most_reformulated functions none are made.
[[nodiscard]] std::string reformulation_text(const model::System& system);

/// Returns lists the totals of the same table as plain data.
[[nodiscard]] std::vector<io::OverviewForm> complementarity_forms(const model::System& system);

/// Returns the ranks of the systems for the multipliers along the solution of the model's [simulate].
[[nodiscard]] std::string ranks_text(const model::System& system, const pipeline::SimulateOptions& options,
                                     const pipeline::Observers& observers);

}  // namespace saltus::frontend
