// Exit functions as rows, of one sliding surface or of several, kept for modes that come back.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/sliding/exit_rows.hpp"

namespace saltus::event_integrator {

class ExitForms {
 public:
  explicit ExitForms(const evaluation::ModelKernel& kernel) : several(kernel), kernel_(kernel) {}

  ExitRows several;  ///< where several independent surfaces are slid on

  /// Returns L psi_surface as a row for these selections, null where it is none; valid until the next call. What cells
  /// and references change is not known again, and neither is what is asked for with `motion` null.
  [[nodiscard]] const evaluation::AffineRow* of(int surface, const evaluation::FixedState& fixed,
                                                const std::vector<double>& alpha, const void* motion);

 private:
  /// Forms that were asked for: solutions come back to their modes.
  struct Known {
    const void* motion = nullptr;  ///< of the kernel
    int surface = 0;
    evaluation::FixedState fixed;
    std::vector<double> alpha;
    evaluation::AffineRow form;
  };

  const evaluation::ModelKernel& kernel_;
  std::array<Known, 8> known_;  ///< the last ones
  std::size_t next_ = 0;
  evaluation::AffineRow form_;  ///< one that is not kept
};

}  // namespace saltus::event_integrator
