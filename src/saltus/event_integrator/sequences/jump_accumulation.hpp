// Jumps that accumulate: how fast their guards move, and the limit of their sequence.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/instant/jump_cascade.hpp"

namespace saltus::event_integrator {

/// JumpAccumulation notes the jumps of a run behind each cascade.
class JumpAccumulation {
 public:
  JumpAccumulation(const SwitchingContext& switching_context, const Position& here);

  /// Notes the jumps of a cascade: when, where to, and which guards were at zero.
  void note(const JumpCascade& cascade, const Jumps& jumps);
  [[nodiscard]] std::optional<SeriesLimit> limit() const { return series_.limit(shortest_cycle_); }
  /// Ends the sequence behind a limit, but for what chatters.
  void end(const SeriesLimit& limit);
  void clear() { series_.clear(); }
  /// Returns how long the last cycle of a contracting sequence was.
  [[nodiscard]] std::optional<double> last_cycle() const { return series_.last_cycle(); }
  /// Returns the guard that was at zero when a jump was executed last; nullopt if there was none.
  [[nodiscard]] std::optional<HeldGuard> last_guard(int jump) const { return last_guard_[at(jump)]; }
  /// Returns the |dg/dt| of that guard then.
  [[nodiscard]] double last_rate(int jump) const { return last_rate_[at(jump)]; }

 private:
  void note_bounces(const JumpCascade& cascade);

  const model::Layout& layout_;
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  EventSeries series_;
  std::vector<std::optional<HeldGuard>> last_guard_;  ///< by jump, as are these
  std::vector<double> last_rate_;
  std::vector<double> shortest_cycle_;  ///< shorter ones are not resolved, for the rounding of the guard
  std::vector<int> executed_;           ///< jumps, in their order
  std::vector<double> magnitude_, slope_;
};

}  // namespace saltus::event_integrator
