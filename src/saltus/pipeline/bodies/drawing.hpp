// The bodies of a mechanical system along a trajectory.
#pragma once

#include <optional>
#include <vector>

#include "saltus/model/system.hpp"
#include "saltus/result/drawing.hpp"
#include "saltus/result/table.hpp"

namespace saltus::pipeline {

/// What the system says is drawn, at states of which its own are the first ones; nothing if it says nothing.
/// @param parameters  values of System::p
[[nodiscard]] std::optional<result::Drawing> drawing_of(const model::System& system,
                                                        const std::vector<double>& parameters,
                                                        const result::Table<double>& states);

}  // namespace saltus::pipeline
