// Ends of cells that are reached: what goes on there, and the rows of the trajectory around them.
#include <algorithm>
#include <utility>

#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

bool Run::reaches_cell_end(const Located& located) const {
  return std::any_of(located.functions.begin(), located.functions.end(),
                     [&](std::size_t i) { return is_cell_end(search_.functions()[i].kind); });
}

CellChange Run::leave_cells(const Located& located) {
  if (!reaches_cell_end(located)) return CellChange::none;
  const auto change = cells_.leave(search_.functions(), located.functions, here_.t, here_.x.data(), here_.state.alpha);
  for (const auto i : located.functions) {
    if (is_cell_end(search_.functions()[i].kind)) search_.entered_cell(search_.functions()[i]);
  }
  return change;
}

/// Breaks at which values jump, at this time to rounding.
Located Run::breaks_here() {
  Located here{here_.t, here_.x, {}, {}};
  for (std::size_t i = 0; i < search_.functions().size() && !cells_.empty(); ++i) {
    if (!cells_.jumps_at(search_.functions()[i], here_.t, here_.x.data(), here_.state.alpha)) continue;
    here.functions.push_back(i);
    here.signs.push_back(search_.functions()[i].sign);
  }
  return here;
}

/// Switching functions that hold constants of a cell that moved last, or selections of such functions.
std::vector<bool> Run::functions_in_moved_cells() const {
  std::vector<bool> moved(at(kernel_.switching_functions()));
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    const auto& inner = kernel_.inner(j);  // of smaller indices
    moved[at(j)] = cells_.moved_in(j) || std::any_of(inner.begin(), inner.end(), [&](int i) { return moved[at(i)]; });
  }
  return moved;
}

/// Values jump: the mode is decided as at a start, but what slides and is still at zero goes on sliding if it can.
bool Run::jump_with_cells() {
  const ModeState& before = event_.before;
  std::vector<int> held, slid;
  const auto moved = functions_in_moved_cells();
  for (const int j : before.sliding) (moved[at(j)] ? slid : held).push_back(j);
  held.insert(held.end(), event_.freed.begin(), event_.freed.end());
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  Transition& transition = event_.transition;
  transition =
      decide_behind_jump(switching_context_, before, here_.t, here_.x.data(), here_.time_scale, held, resting, slid);
  if (transition.termination == Termination::completed && transition.state.mode != before.mode) {
    transition.reason = (transition.reason.empty() ? "" : transition.reason + "; ") + "signs behind the " +
                        (event_.cell_change == CellChange::jump ? "jump of " : "kink of ") +
                        cells_.moved_names(switching_context_.layout);
  }
  search_.forget_user_zeros();
  return go_on();
}

/// Some arguments are defined on this side of a surface only. They are looked up behind it, a few roundings ahead if
/// the surface itself is beside their domain.
bool Run::find_undefined_cells() {
  if (!cells_.any_undefined()) return true;
  std::vector<double> ahead = here_.x;
  for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] += 8.0 * here_.smallest_step() * here_.slope[i];
  const auto change = std::max(cells_.locate_undefined(here_.t, here_.x.data(), here_.state.alpha),
                               cells_.locate_undefined(here_.t, ahead.data(), here_.state.alpha));
  return change == CellChange::none || enter(event_.transition);
}

/// Rows at an event, or at a restart: at requested times that are this time to rounding, before and behind.
void Run::rows_at_event(const Arrival& arrival) {
  const auto cells_behind = cells_.indices();
  cells_.put(event_.cells_before);
  rows_.each_before(-infinity, here_.t,
                    [&](double t) { recorder_.row_before(t, event_.x_before, event_.before, arrival.events); });
  recorder_.row_before(here_.t, event_.x_before, event_.before, arrival.events);
  cells_.put(cells_behind);
}

}  // namespace saltus::event_integrator
