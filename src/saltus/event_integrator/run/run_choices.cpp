// Alternatives of decisions and members of families, followed instead of what was decided.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// A choice is made at the event in hand, which shows this decision.
void Run::note_choice(long decision) {
  ++next_choice_;
  chosen_ = decision;
  choice_row_ = rows_.arrival();
  before_choice_ = result_.statistics;
  before_choice_.rhs_evaluations = kernel_.field_evaluations() - evaluations_before_;
}

/// Gives a decision its number, and makes it the alternative that the run was asked to go on with.
void Run::choose(Transition& transition) {
  if (transition.alternatives.empty() && !transition.beyond_spiral) return;
  const long decision = decisions_++;
  if (const Choice next = next_choice(); !next.of_family() && next.decision == decision) {
    transition = alternative_of(std::move(transition), next.alternative);
    note_choice(decision);
  }
  transition.decision = decision;
  if (transition.beyond_spiral) choose_phase(transition);
}

/// The first lap of a spiral has a size, 1 to lap_ratio times that of any one: its phase.
void Run::choose_phase(Transition& transition) {
  const auto number = static_cast<long>(families_.count());
  families_.add_spirals(here_.t, static_cast<std::size_t>(recorder_.events()), transition);
  const Choice next = next_choice();
  if (!next.phase || next.decision != number) return;
  SpiralStart& start = *transition.beyond_spiral;
  const double size = std::pow(start.lap_ratio, *next.phase);
  start.duration *= size;
  for (std::size_t i = 0; i < here_.x.size(); ++i) start.x[i] = here_.x[i] + size * (start.x[i] - here_.x[i]);
  transition.unique = false;
  transition.reason = fmt::format("followed with the phase {}; {}", *next.phase, transition.reason);
  note_choice(transition.decision);
}

/// The time is that at which the run was asked to leave its mode as a member of a family.
Run::Step Run::leave_later() {
  const auto number = static_cast<std::size_t>(next_choice().decision);
  const auto& open = families_.open();
  const auto family = std::find_if(open.begin(), open.end(), [&](const auto& one) { return one.number == number; });
  if (family == open.end()) return Step::taken;
  const Arrival arrival =
      arrive(recorder_.ends_at(here_.t) ? OutputRows::Arrival::written : OutputRows::Arrival::missing);
  Occasion& occasion = occasion_;
  occasion = Occasion{};
  occasion.t = here_.t;
  occasion.x = here_.x.data();
  occasion.time_scale = here_.time_scale;
  occasion.at_zero = here_.state.sliding;
  for (const auto& given : family->given) occasion.touched.push_back(given.surface);
  auto left = decide_with(surroundings_, before_, occasion, family->given);
  if (!left) return Step::taken;
  left->alternatives.emplace_back();
  left->alternatives.back().state = before_;
  for (const auto& other : open) {
    if (&other == &*family) continue;
    if (auto also = decide_with(surroundings_, before_, occasion, other.given)) {
      left->alternatives.push_back(std::move(*also));
    }
  }
  left->unique = false;
  left->reason = "followed as a branch: leaves at one of the times at which it may" +
                 (left->reason.empty() ? "" : "; " + left->reason);
  transition_ = std::move(*left);
  note_choice(decisions_);  // the number that it gets
  static_cast<void>(go_on());
  return depart(arrival);
}

/// Behind an event: what its mode may be left into, now or later.
void Run::watch_for_families() {
  const bool may_repel = !here_.state.sliding.empty() && recorder_.last_unique() != true;
  const bool coupled = field_.solve() == SlidingSolve::coupled;
  if (families_.idle() && !may_repel && !coupled) return;
  if (!families_.idle() && families_.is_on(here_.state)) return;
  families_.enter({here_.t, here_.x.data(), here_.time_scale}, here_.state,
                  static_cast<std::size_t>(recorder_.events() - 1), recorder_.last_unique());
}

/// Behind a step.
void Run::look_for_families(double t_begin) {
  bool known = false;
  const auto state_at = [&](double t, double* x) {
    if (!known) static_cast<void>(steps_.remake_dense());
    known = true;
    steps_.dense().evaluate((t - steps_.dense().t) / steps_.dense().h, x);
  };
  families_.look({here_.t, here_.x.data(), here_.time_scale}, t_begin, state_at);
}

/// Takes away what lies before the last choice.
void Run::begin_at_choice() {
  auto& recording = result_.recording;
  for (std::size_t i = 0; i < recording.families.size(); ++i) recording.families[i].number = static_cast<long>(i);
  if (options_.choices.empty()) return;
  auto& points = recording.branch_points;
  const auto chosen =
      std::find_if(points.begin(), points.end(), [&](const BranchPoint& point) { return point.decision == chosen_; });
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
