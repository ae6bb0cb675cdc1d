// Whether a result solves a random system, judged by code that shares nothing with the engine.
#pragma once

#include <string>
#include <vector>

#include "random_systems.hpp"
#include "saltus/result/result.hpp"

namespace saltus::robustness {

/// The first thing that is wrong with a run to `rtol`, or an empty string:
///   * a status other than completed, or outside_class with a message;
///   * a row against its mode: psi_j k_j < 0, |psi_j| > 0 while sliding, a selection outside [0, 1];
///   * a stretch between two rows that a Runge-Kutta method of fixed steps does not confirm, or on which it
///     crosses a surface, or slides where a field points away;
///   * an event that does not fit the rows around it, or happens twice.
/// @param listed  per switching function: whether anything jumps on it
[[nodiscard]] std::string complaint(const RandomSystem& system, const std::vector<bool>& listed,
                                    const result::Result& result, double rtol);

}  // namespace saltus::robustness
