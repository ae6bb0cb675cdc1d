// Which entries of the Jacobian of a motion, free or sliding, can be other than 0.
#pragma once

#include <optional>
#include <vector>

#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::evaluation {

/// Says what each row depends on: on which states and selections the components of f depend, and on which states the
/// switching functions.
struct FieldDependencies {
  std::vector<std::vector<int>> field_on_states, field_on_alpha, functions_on_states;
  std::vector<std::vector<int>> neighbours;  ///< of switching functions
};

/// Returns the pattern of d/dx f(x, alpha(x)), where the selections of sliding surfaces are functions of x: those of
/// surfaces that influence each other, of all that moves one of them. Nothing where a dense matrix is as good.
[[nodiscard]] std::optional<ode::JacobianPattern> field_pattern(const FieldDependencies& dependencies);

}  // namespace saltus::evaluation
