// Switches that accumulate: cycles that contract, the tolerances that follow them, and their limit.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/accumulate/switch_series.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"

namespace saltus::event_integrator {

/// Returns a surface with the mode that it changes to, as one number: what has to repeat from cycle to cycle.
inline int label_of(int surface, int mode) { return 3 * surface + mode + 1; }
inline int surface_of(int label) { return label / 3; }

/// SwitchAccumulation notes the switches of a run behind each event. It holds a sequence only while its switches follow
/// each other faster and faster.
class SwitchAccumulation {
 public:
  SwitchAccumulation(const SwitchingContext& switching_context, const Position& here, double span,
                     StepTolerances& tolerances);

  [[nodiscard]] SwitchSeries& series() { return series_; }
  [[nodiscard]] const SwitchSeries& series() const { return series_; }
  [[nodiscard]] bool empty() const { return cycles_.empty(); }
  void clear() { cycles_.clear(); }
  /// Notes a switch to the mode of the position.
  void note(const ModeChange& change);
  /// Limits the tolerances behind a switch. Cycles that contract by q have psi contract by q or, where psi is tangent
  /// to its surface at the limit, q^2: an absolute tolerance that did not follow would end them in noise long before
  /// their limit.
  /// @param roots  whether fields have roots of surfaces that they end at: their tolerances go with these cycles
  enum class Roots { none, ending };
  void limit_tolerances(Roots roots);
  /// Ends it behind a step if it is over. Without a switch for many cycles their sequence has ended before it had a
  /// limit, as spirals do in the layers of a regularisation. What comes has the tolerances of the run.
  void end_if_over(Roots roots);
  /// Returns the duration of the last cycle that was closed, in a sequence.
  [[nodiscard]] std::optional<double> cycle() const { return empty() ? std::nullopt : std::optional(closed_); }

  /// Returns the limit of the switches up to here, if there is one.
  [[nodiscard]] std::optional<SeriesLimit> limit() const { return cycles_.limit(shortest_); }
  [[nodiscard]] std::optional<SeriesLimit> nearly() const { return cycles_.nearly(); }
  /// Does the same whatever remains: cycles that hardly contract are too many for their time before a limit is asked
  /// for.
  [[nodiscard]] std::optional<SeriesLimit> dense_limit() const;
  /// Returns the limit where a switch of this surface cannot be decided, in a cycle of this duration. Cycles that are
  /// not longer than the rounding of psi resolves have their limit where they are.
  [[nodiscard]] std::optional<SeriesLimit> unresolved(int surface, int mode, double duration) const;
  /// Returns whether limits follow each other at once, cycles of rounding between them: the solution stays where the
  /// switches have come together (sliding of second order on some surfaces), and no mode found there is that.
  [[nodiscard]] bool limits_repeat(double t);

 private:
  /// Limits of switches that follow each other at once.
  struct LimitsInARow {
    int count = 0;
    double last = 0.0;         ///< time of the last one
    double first_cycle = 0.0;  ///< of the sequence before the first one
  };
  [[nodiscard]] bool find_labels(const ModeState& before);
  void note_rates(const std::vector<double>& alpha_before);

  const SwitchingContext& switching_context_;
  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  StepTolerances& tolerances_;
  FieldRates rates_;
  SwitchSeries series_;
  EventSeries cycles_;            ///< by surface and mode behind
  std::vector<int> labels_;       ///< of the last switch
  std::vector<bool> slid_;        ///< of the surfaces of labels_: before the change
  std::vector<double> shortest_;  ///< by label: shorter cycles are not resolved, for the rounding of psi
  double first_ = 0.0;            ///< duration of the first cycle that was closed
  double closed_ = 0.0;           ///< and of the last one
  LimitsInARow limits_in_a_row_;
  std::vector<double> slope_, alpha_;
};

}  // namespace saltus::event_integrator
