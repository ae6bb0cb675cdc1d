// How the parameter of the relaxed problems is driven to zero: by a schedule, or as a variable with a price.
#pragma once

#include <array>
#include <string_view>

namespace saltus::solver::homotopy {

/// Says how; elastic problems are feasible wherever the rest of the problem is, and stop relaxing pairs that need it no
/// more.
enum class Steering {
  direct,  ///< phi(G_i, H_i; sigma) <= 0
  l1,      ///< phi(G_i, H_i; s_i) <= 0, 0 <= s_i <= 10, and f + sum_i s_i / sigma
  linf,    ///< the same with one s for all pairs: f + s / sigma
};
inline constexpr std::array all_steerings{Steering::direct, Steering::l1, Steering::linf};

/// Returns the name of a steering in model files.
[[nodiscard]] std::string_view name(Steering steering);

}  // namespace saltus::solver::homotopy
