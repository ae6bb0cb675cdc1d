// What kind of stationary point a point is: by signs of multipliers, and by what is small.
#pragma once

#include "saltus/result/optimization.hpp"
#include "saltus/solver/certificate/multipliers.hpp"

namespace saltus::solver::certificate {

/// Finds which pairs are biactive at w (both sides <= 10 tolerance), and which of them have a choice: all pairs of
/// their group are biactive, and the closure of the branch does not hold their zero side.
/// @param sides  the zero side of each pair, G or H
[[nodiscard]] PairStates pair_states(mpcc::Problem& problem, ConstVectorView w,
                                     const std::vector<mpcc::ActiveSide>& sides, double tolerance);

/// Returns the strongest type that the signs of the multipliers on biactive pairs allow. A multiplier counts as zero up
/// to 10 tolerance, relative to the largest of them, at least 1.
[[nodiscard]] result::StationarityType stationarity_type(const MpccMultipliers& multipliers,
                                                         const std::vector<bool>& biactive, double tolerance);

/// Returns the largest violation of a bound or row over max(1, |its bound|), and of G >= 0, H >= 0; NaN if not finite.
[[nodiscard]] double scaled_infeasibility(mpcc::Problem& problem, ConstVectorView w);
/// Returns max_i min(|G_i|, |H_i|); NaN if not finite.
[[nodiscard]] double complementarity(mpcc::Problem& problem, ConstVectorView w);
/// Returns "name violates its bound by 0.3, ...": the worst bounds, rows and pairs that are violated by more than the
/// tolerance.
[[nodiscard]] std::string worst_rows(mpcc::Problem& problem, ConstVectorView w, double tolerance);

}  // namespace saltus::solver::certificate
