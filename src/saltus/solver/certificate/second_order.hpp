// Whether the objective of a branch problem rises to second order along all directions that constraints leave.
#pragma once

#include <optional>

#include "saltus/solver/certificate/active_constraints.hpp"

namespace saltus::solver::certificate {

/// Decides it at a solution of a branch problem, by the signs of the eigenvalues of [H A'; A 0] for the gradients A of
/// active constraints: those with a multiplier above `zero` alone have to suffice. False where the objective falls
/// along a direction in which all active constraints stay so; nullopt where neither is known, since a curvature is
/// zero to rounding or depends on inequalities without a multiplier. Cost: up to two factorisations.
[[nodiscard]] std::optional<bool> is_second_order_sufficient(mpcc::Problem& problem, crossover::Branch& branch,
                                                             const ActiveConstraints& active, double zero);

}  // namespace saltus::solver::certificate
