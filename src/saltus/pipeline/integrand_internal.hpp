// What the event engine integrates: a system, or its regularisation.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "saltus/base/error.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/smoothed/regularise.hpp"

namespace saltus::pipeline {

/// Returns a copy that takes the SymbolicLock where it is made and dropped.
[[nodiscard]] std::shared_ptr<const model::System> own_copy(const model::System& system);

/// Holds the system itself, which must outlive it, or its regularisation.
class Integrand {
 public:
  [[nodiscard]] static Expected<Integrand> make(const model::System& system, const SimulateOptions& options);
  Integrand(Integrand&&) = default;
  ~Integrand();

  [[nodiscard]] const model::System& system() const { return regularisation_ ? regularisation_->system : *system_; }
  /// Returns how many of the last outputs are selections.
  [[nodiscard]] std::size_t selections() const;
  [[nodiscard]] event_integrator::ThinLayers layers() const;
  /// Returns what was computed, over the columns of the original system.
  [[nodiscard]] event_integrator::Integration restated(event_integrator::Integration run) const;
  /// Does this for rows.
  [[nodiscard]] result::Trajectory restated(result::Trajectory rows) const;

 private:
  explicit Integrand(const model::System& system) : system_(&system) {}
  explicit Integrand(smoothed::Regularisation regularisation) : regularisation_(std::move(regularisation)) {}

  const model::System* system_ = nullptr;
  std::optional<smoothed::Regularisation> regularisation_;
};

}  // namespace saltus::pipeline
