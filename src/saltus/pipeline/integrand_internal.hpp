// What the event engine integrates: a system, or its regularisation.
#pragma once

#include <cstddef>
#include <memory>

#include "saltus/base/error.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"

namespace saltus::model {
struct System;
}
namespace saltus::smoothed {
struct Regularisation;
}

namespace saltus::pipeline {

/// Returns a copy that takes the SymbolicLock where it is made and dropped.
[[nodiscard]] std::shared_ptr<const model::System> own_copy(const model::System& system);

/// Holds the system itself, which must outlive it, or its regularisation.
class Integrand {
 public:
  [[nodiscard]] static Expected<Integrand> make(const model::System& system, const SimulateOptions& options);

  [[nodiscard]] const model::System& system() const { return *system_; }
  /// Returns how many of the last outputs are selections.
  [[nodiscard]] std::size_t selections() const;
  [[nodiscard]] event_integrator::ThinLayers layers() const;
  /// Returns what was computed, over the columns of the original system.
  [[nodiscard]] event_integrator::Integration restated(event_integrator::Integration run) const;
  /// Does this for rows.
  [[nodiscard]] result::Trajectory restated(result::Trajectory rows) const;

 private:
  explicit Integrand(const model::System& system) : system_(&system) {}
  explicit Integrand(std::shared_ptr<const smoothed::Regularisation> regularisation);

  const model::System* system_ = nullptr;
  std::shared_ptr<const smoothed::Regularisation> regularisation_;  ///< null for the system itself
};

}  // namespace saltus::pipeline
