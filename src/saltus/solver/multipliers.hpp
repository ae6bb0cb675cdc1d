// Multipliers of a problem with complementarities, as the solver finds them.
#pragma once

#include "saltus/mpcc/multipliers.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::solver {

using MpccMultipliers = mpcc::Multipliers;

/// Moves multipliers of bounds, `pressure` = lower - upper, to one implied side, as far as their signs allow.
/// @param row  of (g, G, H): that of the side
void take_from_bounds(const RowMatrix& jacobian, int row, linalg::Vector& pressure, double& multiplier);

}  // namespace saltus::solver
