// The bodies of a mechanical system along a trajectory.
#pragma once

#include <optional>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Returns what the system says is drawn, at the rows of a trajectory of its first states; nothing if it says nothing.
/// @param parameters  values of System::p
[[nodiscard]] std::optional<result::Drawing> drawing_of(const model::System& system,
                                                        const std::vector<double>& parameters,
                                                        const result::Trajectory& trajectory);

/// Does this with the values of the system.
[[nodiscard]] std::optional<result::Drawing> drawing_of(const model::System& system,
                                                        const result::Trajectory& trajectory);

}  // namespace saltus::pipeline
