// Alternatives of decisions, followed instead of what was decided.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "saltus/event_integrator/continuations.hpp"
#include "saltus/event_integrator/run_internal.hpp"

namespace saltus::event_integrator {

/// Gives a decision its number, and makes it the alternative that the run was asked to go on with.
void Run::choose(Transition& transition) {
  if (transition.alternatives.empty()) return;
  const long decision = decisions_++;
  const auto& choices = options_.choices;
  if (next_choice_ < choices.size() && choices[next_choice_].decision == decision) {
    const std::size_t alternative = choices[next_choice_++].alternative;
    transition = alternative_of(std::move(transition), alternative);
    choice_row_ = arrival_row_;
    before_choice_ = result_.statistics;
    before_choice_.rhs_evaluations = kernel_.field_evaluations() - evaluations_before_;
  }
  transition.decision = decision;
}

/// Takes away what lies before the last choice.
void Run::begin_at_choice() {
  if (options_.choices.empty()) return;
  const long decision = options_.choices.back().decision;
  auto& recording = result_.recording;
  auto& points = recording.branch_points;
  const auto chosen =
      std::find_if(points.begin(), points.end(), [&](const BranchPoint& point) { return point.decision == decision; });
  result_.chosen = next_choice_ == options_.choices.size() && chosen != points.end();
  if (!result_.chosen) return;
  const std::size_t events_before = chosen->event;
  // Requested times that are the event but for their rounding have rows of their own.
  while (recording.row_times[choice_row_] < recording.event_list[events_before].t) ++choice_row_;
  points.erase(points.begin(), chosen + 1);
  for (auto& point : points) point.event -= events_before;
  recording.drop(events_before, choice_row_);
  auto& statistics = result_.statistics;
  statistics.steps -= before_choice_.steps;
  statistics.rejected -= before_choice_.rejected;
  statistics.rhs_evaluations -= before_choice_.rhs_evaluations;
}

}  // namespace saltus::event_integrator
