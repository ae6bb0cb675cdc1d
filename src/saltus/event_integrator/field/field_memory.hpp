// What the fields of the last regions are made of: solutions come back to their regions.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::event_integrator {

/// Keeps the constants of the right-hand side for some regions (modes without sliding), so that a switch does not make
/// them again from all selections.
class FieldMemory {
 public:
  explicit FieldMemory(const evaluation::ModelKernel& kernel) : kernel_(kernel) {}

  /// Returns those of the selections `alpha` (n_psi). Valid until the call behind the next one.
  /// @param mark  of the region: different ones rarely have the same
  /// Cost: one comparison of selections; allocates for regions that are not among the last ones only.
  [[nodiscard]] const evaluation::FieldConstants& of(const std::vector<double>& alpha, std::size_t mark);

 private:
  static constexpr std::size_t capacity = 64;

  const evaluation::ModelKernel& kernel_;
  std::array<std::size_t, capacity> marks_{};  ///< beside each other: they are gone through at every switch
  std::array<evaluation::FieldConstants, capacity> constants_;
  std::size_t used_ = 0;
  std::size_t next_ = 0;         ///< to be overwritten
  std::size_t last_ = capacity;  ///< handed out last
};

}  // namespace saltus::event_integrator
