// Which sides of pairs are nonnegative by the bounds of the variables alone.
#pragma once

#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

#include "saltus/mpcc/problem.hpp"

namespace saltus::foreign {

/// Returns one per side (row of `sides`): implied if it is affine in w and a sum of distances of variables from their
/// finite bounds with positive weights.
/// @param jacobian  of sides
[[nodiscard]] std::vector<mpcc::Sign> signs_of(const casadi::SX& w, const casadi::SX& sides, const casadi::SX& jacobian,
                                               const mpcc::Bounds& bounds);

}  // namespace saltus::foreign
