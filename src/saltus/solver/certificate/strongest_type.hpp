// The strongest type of stationarity that some multipliers of a point have.
#pragma once

#include "saltus/result/optimization.hpp"
#include "saltus/solver/certificate/multiplier_set.hpp"

namespace saltus::solver::certificate {

/// Returns the strongest type that multipliers of the set allow, `found` if none is stronger or if sides have no
/// multipliers of their own. Cost: up to some hundred linear programs, where many pairs are biactive; what they leave
/// open counts as not allowed.
/// @param found  of the multipliers at hand
/// @param zero   multipliers that are no larger count as zero
[[nodiscard]] result::StationarityType strongest_type(mpcc::Problem& problem, const MultiplierSet& set,
                                                      const std::vector<bool>& biactive, result::StationarityType found,
                                                      double zero, LpccSolver& linear);

}  // namespace saltus::solver::certificate
