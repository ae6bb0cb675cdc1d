// Norms in a right-hand side that a solution makes vanish: there it has no direction.
#pragma once

#include <string>
#include <vector>

namespace saltus::model {

struct System;

/// Says that states tend to where a norm of theirs vanishes, and what to do: "; vx, vy tend to where" and so on. That
/// is so if hypot or sqrt of states in the right-hand side is next to nothing at (t, x) of what it was at the start.
/// The text is empty without one. Controls count as their initial values, selections as 1/2. Cost: two evaluations,
/// interpreted.
[[nodiscard]] std::string vanishing_norm(const System& system, double t, const std::vector<double>& x);

}  // namespace saltus::model
