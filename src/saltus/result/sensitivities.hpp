// First derivatives of the end state.
#pragma once

#include <string>
#include <vector>

namespace saltus::result {

/// Holds derivatives, whose rows are states; an entry that is not defined is NaN.
struct Sensitivities {
  std::vector<std::vector<double>> x0;  ///< d x_i(T) / d x_j(t_0), n_x by n_x
  std::vector<std::vector<double>> p;   ///< d x_i(T) / d p_j at fixed initial state, n_x by n_p
  std::vector<std::string> parameters;  ///< names of the columns of p
};

}  // namespace saltus::result
