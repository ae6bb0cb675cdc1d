// Rows of the exit functions of independent sliding surfaces, kept for modes that come back.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::event_integrator {

/// Makes L psi_j along f with alpha_j = 0 or 1, as a row. It depends on few other selections, and is made anew where
/// one of these has changed.
class ExitRows {
 public:
  explicit ExitRows(const evaluation::ModelKernel& kernel) : kernel_(kernel) {}

  /// Says whether a row stays what it is while these selections and the fixed state do: cells and references change it.
  enum class Rows { lasting, changing };

  /// Returns the row; null where it is none. `alpha` are the selections of the mode, of which that of the surface is
  /// replaced by `side`. Valid until the next call for the same surface and side.
  [[nodiscard]] const evaluation::AffineRow* of(int surface, double side, const evaluation::FixedState& fixed,
                                                const std::vector<double>& alpha, Rows rows);

 private:
  struct Entry {
    const void* motion = nullptr;  ///< of the kernel
    bool is_row = false;
    evaluation::FixedState fixed;
    std::vector<double> beside;  ///< selections of the surface's neighbours
    evaluation::AffineRow row;
  };
  struct Known {
    std::vector<Entry> entries;
    std::size_t oldest = 0;  ///< where there are as many as are kept
  };

  const evaluation::ModelKernel& kernel_;
  std::vector<Known> known_;  ///< two of each surface
  std::vector<double> alpha_;
};

}  // namespace saltus::event_integrator
