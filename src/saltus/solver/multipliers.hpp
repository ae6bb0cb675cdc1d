// Multipliers of a problem with complementarities.
#pragma once

#include <Eigen/Core>

namespace saltus::solver {

/// Holds multipliers of L = f + rows'g + lower'(l - w) + upper'(w - u) - G'G - H'H, lower and upper >= 0.
struct MpccMultipliers {
  Eigen::VectorXd rows, lower, upper, G, H;
};

}  // namespace saltus::solver
