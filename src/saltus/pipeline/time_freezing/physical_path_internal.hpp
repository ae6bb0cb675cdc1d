// An optimised trajectory of a frozen system, as the event engine takes it.
#pragma once

#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"

namespace saltus::pipeline {

/// Returns the problem over Ocp::physical instead of the frozen system: controls and constraints are the same ones.
[[nodiscard]] model::Ocp physical_ocp(const model::Ocp& ocp);

/// Returns the path in physical time over the states of Ocp::physical. At nodes a hysteresis is 0 or 1, closed gaps are
/// 0, and modes of contacts are open: the event engine finds them.
/// @param run  trajectory and events of the result, in physical time
[[nodiscard]] Expected<OptimizedPath> physical_path(const model::Ocp& ocp, const OptimizedPath& path,
                                                    const result::Result& run);

/// Gives the impacts of an optimised trajectory their impulses, and the contacts that have one: a frozen system of an
/// optimisation does not sum them up.
[[nodiscard]] Expected<void> add_impulses(const model::Ocp& ocp, const std::vector<double>& parameters,
                                          result::Result& run);

}  // namespace saltus::pipeline
