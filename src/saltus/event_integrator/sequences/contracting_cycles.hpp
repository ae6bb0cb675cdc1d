// Cycles of switches that contract, but not by a ratio: what they are, for the message of a run that ends in them.
#pragma once

#include <optional>
#include <string>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/record/recorder.hpp"

namespace saltus::event_integrator {

/// ContractingCycles looks at the events of a run that max_events has ended.
class ContractingCycles {
 public:
  ContractingCycles(const SwitchingContext& switching_context, const Position& here, const Recorder& recorder)
      : switching_context_(switching_context),
        kernel_(switching_context.kernel),
        here_(here),
        recorder_(recorder),
        rates_(kernel_, here) {}

  /// Returns what has ended the run, where that is a sequence that contracts like a power of its number; empty
  /// elsewhere.
  [[nodiscard]] std::string describe();

 private:
  [[nodiscard]] double mean_interval(long first, long count) const;
  [[nodiscard]] double last_interval(long count) const;
  [[nodiscard]] long resolved_events(double farthest, double rounding) const;
  [[nodiscard]] std::optional<double> exponent_of(long n) const;
  [[nodiscard]] bool has_one_rate(int surface);

  const SwitchingContext& switching_context_;
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  const Recorder& recorder_;
  FieldRates rates_;
};

}  // namespace saltus::event_integrator
