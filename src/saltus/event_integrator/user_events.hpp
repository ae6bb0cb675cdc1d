// [[events]]: zeros of expressions and edges of conditions.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/system.hpp"

namespace saltus::event_integrator {

/// Follows the signs of the user functions and the truth of the conditions from event to event.
class UserEvents {
 public:
  UserEvents(const evaluation::ModelKernel& kernel, const model::System& system);

  /// Takes the signs (-1, 0, 1) of all user functions in force from now on and returns which entries of [[events]]
  /// fire: expressions whose sign changed in their direction, conditions whose truth did. The first call only sets up.
  [[nodiscard]] std::vector<int> update(double t, const double* x, const std::vector<double>& alpha,
                                        const std::vector<int>& signs);
  [[nodiscard]] bool stops(int event) const;

 private:
  const evaluation::ModelKernel& kernel_;
  const model::System& system_;
  std::vector<std::vector<int>> places_;  ///< of every entry in the list of user functions
  std::vector<int> state_;                ///< sign of an expression, truth (0 or 1) of a condition
  bool started_ = false;
};

}  // namespace saltus::event_integrator
