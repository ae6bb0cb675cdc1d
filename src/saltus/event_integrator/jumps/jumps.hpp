// [[jumps]]: which conditions hold, which executions wait, at which times something is due.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/same_time.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {

/// Says where conditions and right-hand sides of jumps are evaluated.
struct JumpPoint {
  double t = 0.0;
  const std::vector<double>& x;      ///< n_x
  const std::vector<double>& alpha;  ///< n_psi
  const std::vector<int>& signs;     ///< of the user functions (those behind psi), just behind this time; 0 = at zero
  const std::vector<int>& zeros;     ///< event functions that are at zero whatever is left of their value
};

/// Returns a switching function or a jump that a discrete state decides, so that it is read at jumps only; nothing
/// without.
[[nodiscard]] std::optional<std::string> compared_at_jumps_only(const model::Layout& layout, int state);

/// Holds the span of a run.
struct JumpSpan {
  double from = 0.0;
  double until = 0.0;
  std::optional<double> begun;  ///< of a run that goes on at the end of another: see IntegrationOptions
};

/// Follows the truth of all conditions and the queue of executions (rules 1 to 5 of the model file's [[jumps]]). Knows
/// no modes and takes no steps; it is asked at events only.
class Jumps {
 public:
  Jumps(const evaluation::ModelKernel& kernel, const JumpSpan& span);

  [[nodiscard]] bool none() const { return layout_.jumps.empty(); }
  /// Begins at the start: every condition counts as true before it, with at_start as false; in a run that goes on only
  /// where its jump would end it, so that it has not happened.
  void begin(const JumpPoint& point);
  /// Reads all conditions and times anew: what became true, and times that have come, are triggered; waiting executions
  /// of jumps with persistent = false whose condition is false are dropped.
  void update(const JumpPoint& point);

  /// Reads the conditions without triggering: those that came true at a limit where their jumps change nothing.
  void accept(const std::vector<int>& jumps, const JumpPoint& point);

  /// Returns when the next given or delayed time comes; infinity without. All times that are the same but for
  /// rounding come together: at the end of the run, else at that of `at`, else at the first one.
  [[nodiscard]] double next_time() const { return next_time_; }
  [[nodiscard]] bool due(double t) const;
  /// Applies the `set` of the due execution with the largest priority (ties: order in the file, then of triggering) to
  /// x, all at once. Returns the jump; only where something is due and nothing has failed.
  int execute(const JumpPoint& point, std::vector<double>& x);
  /// Returns what is wrong with a delay, priority or value that was evaluated; empty if nothing is.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns whether that is a jump whose trigger must not come.
  [[nodiscard]] bool came_to_forbidden() const { return came_to_forbidden_; }

  /// Returns whether the condition of a jump held when it was read last.
  [[nodiscard]] bool holds(int jump) const { return truth_[static_cast<std::size_t>(jump)] != 0U; }
  /// Returns whether an event function is compared in a condition.
  [[nodiscard]] bool is_compared(int function) const;
  /// Returns whether a guard depends on discrete states and constants only: compared exactly, changed by jumps only.
  [[nodiscard]] bool is_discrete_guard(int function) const;
  /// Returns the sign of a guard (event function) that triggers its jump, with all others as they are: -1 or 1; 0 if it
  /// has no say. `inward`: the sign that counts for a guard of direction both.
  [[nodiscard]] int trigger_sign(int jump, int guard, const JumpPoint& point, int inward) const;

 private:
  struct Execution {
    int jump = 0;
    double t = 0.0;
    std::vector<double> values;  ///< empty: evaluated at execution
  };
  /// Bits: 1 the condition holds (guards: g on the wanted side, both: g < 0), 2 (both only) g > 0.
  [[nodiscard]] unsigned truth(int jump, const JumpPoint& point) const;
  [[nodiscard]] bool read_steps(int jump, const JumpPoint& point) const;
  [[nodiscard]] int guard_sign(int function, const JumpPoint& point) const;
  /// Selections as right-hand sides take them: psi at zero has its selection of sliding, or else 1/2.
  [[nodiscard]] std::vector<double> at_instant(const JumpPoint& point) const;
  /// Returns whether a condition is false behind its jump from this point.
  [[nodiscard]] bool ends_itself(int jump, const JumpPoint& point) const;
  void trigger(int jump, const JumpPoint& point);
  [[nodiscard]] double time_of(int jump) const;
  [[nodiscard]] bool is_same(double a, double b) const { return is_same_time(a, b, origin_); }
  [[nodiscard]] bool has_come(double time, double t) const { return time <= t || is_same(time, t); }
  [[nodiscard]] long passed_before_start(int jump) const;
  void find_next_time();

  const evaluation::ModelKernel& kernel_;
  const model::Layout& layout_;
  JumpSpan span_;
  double origin_;  ///< periods count from there
  std::vector<unsigned> truth_;
  mutable std::vector<std::vector<double>> steps_;  ///< of the guards of every condition, as they were read last
  std::vector<long> times_passed_;                  ///< of every jump with given times
  mutable std::vector<double> values_;
  std::vector<Execution> queue_;  ///< in the order of triggering
  double next_time_;
  std::string problem_;
  bool came_to_forbidden_ = false;
};

}  // namespace saltus::event_integrator
