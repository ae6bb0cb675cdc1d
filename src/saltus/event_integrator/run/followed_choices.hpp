// The choices that a run was asked for: alternatives of decisions and members of families, instead of what was decided.
#pragma once

#include <cstddef>
#include <limits>

#include "saltus/event_integrator/branches/families.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/steps/step_attempt.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// FollowedChoices numbers the decisions of a run and makes the choices in their order.
class FollowedChoices {
 public:
  /// Says what the run has done so far: a result that begins at a choice leaves it out.
  struct Progress {
    std::size_t row = 0;  ///< before the current event
    result::Statistics statistics;
  };

  FollowedChoices(const SwitchingContext& switching_context, const IntegrationOptions& options, const Position& here,
                  const Recorder& recorder)
      : families_(switching_context), options_(options), here_(here), recorder_(recorder) {}

  [[nodiscard]] Families& families() { return families_; }
  [[nodiscard]] const Families& families() const { return families_; }
  /// Returns the next choice; one that never comes if there is none.
  [[nodiscard]] Choice next() const { return next_ < options_.choices.size() ? options_.choices[next_] : Choice{-1}; }
  /// Returns when the run is to leave its mode as a member of a family; infinity if it is not.
  [[nodiscard]] double next_departure() const {
    const double time = next().departure();
    return time > here_.t ? time : std::numeric_limits<double>::infinity();
  }
  /// Returns whether this is the alternative that the run was asked to go on with last.
  [[nodiscard]] bool chooses(const Transition& transition) const {
    return next_ > 0 && transition.decision == chosen_ && !transition.alternatives.empty();
  }
  /// Gives a decision its number, and makes it the alternative that the run was asked to go on with.
  void choose(Transition& transition, const Progress& progress);
  /// Returns the family that the run is asked to leave into now; nullptr where it is closed.
  [[nodiscard]] const Families::Open* departing() const;
  /// Makes that choice with the next decision.
  void depart(const Progress& progress) { note(decisions_, progress); }
  /// Watches, behind an event, what its mode may be left into, now or later.
  void watch(const ModeField& field);
  /// Does the same behind a step from t_begin.
  void look(double t_begin, StepAttempt& steps);
  /// Takes away what lies before the last choice; returns whether all choices were made.
  bool begin_at_choice(Recording& recording, result::Statistics& statistics);

 private:
  void note(long decision, const Progress& progress);
  void choose_phase(Transition& transition, const Progress& progress);
  [[nodiscard]] Families::Point point() const { return {here_.t, here_.x.data(), here_.time_scale}; }

  Families families_;
  const IntegrationOptions& options_;
  const Position& here_;
  const Recorder& recorder_;
  long decisions_ = 0;  ///< with alternatives, or of spirals, so far
  long chosen_ = -1;    ///< the one at which the last choice was made
  std::size_t next_ = 0;
  Progress before_;  ///< before the last choice
};

}  // namespace saltus::event_integrator
