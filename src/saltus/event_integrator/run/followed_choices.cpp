#include "saltus/event_integrator/run/followed_choices.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/continuations.hpp"

namespace saltus::event_integrator {

void FollowedChoices::note(long decision, const Progress& progress) {
  ++next_;
  chosen_ = decision;
  before_ = progress;
}

void FollowedChoices::choose(Transition& transition, const Progress& progress) {
  if (transition.alternatives.empty() && !transition.beyond_spiral) return;
  const long decision = decisions_++;
  if (const Choice choice = next(); !choice.of_family() && choice.decision == decision) {
    transition = alternative_of(std::move(transition), choice.alternative);
    note(decision, progress);
  }
  transition.decision = decision;
  if (transition.beyond_spiral) choose_phase(transition, progress);
}

/// The first cycle of a spiral has a size, 1 to cycle_ratio times that of any one: its phase.
void FollowedChoices::choose_phase(Transition& transition, const Progress& progress) {
  const auto number = static_cast<long>(families_.count());
  families_.add_spirals(here_.t, static_cast<std::size_t>(recorder_.events()), transition);
  const Choice choice = next();
  if (!choice.phase || choice.decision != number) return;
  SpiralStart& start = *transition.beyond_spiral;
  const double size = std::pow(start.cycle_ratio, *choice.phase);
  start.duration *= size;
  for (std::size_t i = 0; i < here_.x.size(); ++i) start.x[i] = here_.x[i] + size * (start.x[i] - here_.x[i]);
  transition.unique = false;
  transition.reason = fmt::format("followed with the phase {}; {}", *choice.phase, transition.reason);
  note(transition.decision, progress);
}

const Families::Open* FollowedChoices::departing() const {
  const auto number = static_cast<std::size_t>(next().decision);
  const auto& open = families_.open();
  const auto family = std::find_if(open.begin(), open.end(), [&](const auto& one) { return one.number == number; });
  return family == open.end() ? nullptr : &*family;
}

void FollowedChoices::watch(const ModeField& field) {
  const bool may_repel = !here_.state.sliding.empty() && recorder_.last_unique() != true;
  const bool coupled = field.solve() == SlidingSolve::coupled;
  if (families_.idle() && !may_repel && !coupled) return;
  if (!families_.idle() && families_.is_on(here_.state)) return;
  families_.enter(point(), here_.state, static_cast<std::size_t>(recorder_.events() - 1), recorder_.last_unique());
}

void FollowedChoices::look(double t_begin, StepAttempt& steps) {
  bool known = false;
  const auto state_at = [&](double t, double* x) {
    if (!known) static_cast<void>(steps.remake_dense());
    known = true;
    steps.dense().evaluate((t - steps.dense().t) / steps.dense().h, x);
  };
  families_.look(point(), t_begin, state_at);
}

bool FollowedChoices::begin_at_choice(Recording& recording, result::Statistics& statistics) {
  for (std::size_t i = 0; i < recording.families.size(); ++i) recording.families[i].number = static_cast<long>(i);
  if (options_.choices.empty()) return true;
  auto& points = recording.branch_points;
  const auto chosen =
      std::find_if(points.begin(), points.end(), [&](const BranchPoint& point) { return point.decision == chosen_; });
  if (next_ != options_.choices.size() || chosen == points.end()) return false;
  const std::size_t events_before = chosen->event;
  // Requested times that are the event but for their rounding have rows of their own.
  std::size_t row = before_.row;
  while (recording.row_times[row] < recording.event_list[events_before].t) ++row;
  points.erase(points.begin(), chosen + 1);
  for (auto& point : points) point.event -= events_before;
  recording.drop(events_before, row);
  statistics.steps -= before_.statistics.steps;
  statistics.rejected -= before_.statistics.rejected;
  statistics.rhs_evaluations -= before_.statistics.rhs_evaluations;
  return true;
}

}  // namespace saltus::event_integrator
