// Between which values rows stay, whatever the variables do within their bounds.
#pragma once

#include <casadi/core/sx.hpp>

#include "saltus/mpcc/problem.hpp"

namespace saltus::foreign {

/// Returns the bounds of the variables, and what rows that are affine in one variable alone leave of them.
/// @param of_rows  of the first rows; others have none
[[nodiscard]] mpcc::Bounds with_rows_of_one_variable(const casadi::SX& w, const casadi::SX& rows,
                                                     const casadi::SX& jacobian, mpcc::Bounds bounds,
                                                     const mpcc::Bounds& of_rows);

/// Returns the least and the greatest value of each row that is affine in w, infinite for the others. Constants count
/// as affine.
/// @param jacobian  of rows
[[nodiscard]] mpcc::Bounds ranges_of(const casadi::SX& w, const casadi::SX& rows, const casadi::SX& jacobian,
                                     const mpcc::Bounds& bounds);

}  // namespace saltus::foreign
