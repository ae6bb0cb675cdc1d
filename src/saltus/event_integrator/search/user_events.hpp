// [[events]]: zeros of expressions and edges of conditions.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/model/statement/event_rules.hpp"

namespace saltus::event_integrator {

/// Follows the signs of the user functions and the truth of the conditions from event to event.
class UserEvents {
 public:
  explicit UserEvents(const evaluation::ModelKernel& kernel);

  /// Takes the signs (-1, 0, 1) of all user functions in force from now on, in the kernel's order, and returns which
  /// entries of [[events]] fire. The first call only sets up.
  [[nodiscard]] std::vector<std::size_t> update(double t, const double* x, const std::vector<double>& alpha,
                                                const std::vector<int>& signs);
  /// Returns whether an event function is compared in a condition.
  [[nodiscard]] bool is_compared(int function) const;
  [[nodiscard]] bool stops(std::size_t event) const;

 private:
  const evaluation::ModelKernel& kernel_;
  const model::Layout& layout_;
  model::EventStates states_;
};

}  // namespace saltus::event_integrator
