// Guards of jumps at rest: which are held, and which surfaces they keep at zero.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

}  // namespace

/// The surfaces that held guards and contacts keep at zero; false if these cannot be followed, with the status set.
bool Run::find_resting(RestingSurfaces& resting) {
  resting = find_resting_surfaces(switching_context_, holding_, here_.t, here_.state.alpha, here_.x);
  if (contacts_.hold(here_.x))
    add_kept_by_contacts(switching_context_, contacts_, here_.t, here_.state.alpha, here_.x, resting);
  if (resting.problem.empty()) return true;
  fail(Termination::outside_class, fmt::format("at t = {:.17g} {}", here_.t, resting.problem));
  return false;
}

/// Holds the guards at rest. Returns whether the field has changed.
bool Run::hold_resting() {
  auto [guards, loose] = cascade_.pressed_guards();
  const auto is_in = [](const std::vector<HeldGuard>& list, const HeldGuard& guard) {
    return std::any_of(list.begin(), list.end(),
                       [&](const HeldGuard& other) { return other.hold.function == guard.hold.function; });
  };
  const auto was_executed = [&](int jump) {
    const auto items = cascade_.executed().items();
    return std::any_of(items.begin(), items.end(), [&](const auto& executed) { return executed.jump == jump; });
  };
  const auto kept = cascade_.guards_kept_by_sliding({guards, loose});
  guards.insert(guards.end(), kept.begin(), kept.end());
  if (guards.empty()) return false;
  for (const auto& guard : guards) {
    const int jump = guard.hold.jump;
    if (is_in(cascade_.held_before(), guard) || !was_executed(jump) || contains(cascade_.resting(), jump)) continue;
    cascade_.resting().push_back(jump);
  }
  return hold(std::move(guards), std::move(loose));
}

/// Puts the state on the guards and keeps it there; false if that fails, with the status set.
bool Run::hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose) {
  for (const auto* list : {&guards, &loose}) {
    for (const auto& guard : *list) {
      cascade_.add_zero(guard.hold.function);
    }
  }
  if (const auto problem = holding_.hold(std::move(guards), std::move(loose), here_.t, here_.state.alpha, here_.x)) {
    fail(Termination::outside_class, fmt::format("at t = {:.17g} {}", here_.t, *problem));
    return false;
  }
  search_.set_held(holding_.held());
  cascade_.read_user_signs();
  return true;
}

/// Guards at a limit whose jumps let a motion go on: the state is at rest on them, and what slides, if anything, keeps
/// it there. false if the others cannot be held, with the status set.
bool Run::free_passing() {
  auto guards = holding_.held().all();
  const auto passed = std::erase_if(
      guards, [&](const HeldGuard& guard) { return !holding_.can_rest(guard, here_.t, here_.state.alpha, here_.x); });
  if (passed == 0) return true;
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  for (const int j : resting.surfaces) cascade_.add_zero(j);
  return hold(std::move(guards), {});
}

/// Whether in the cells that were entered the guards at rest keep other surfaces at zero than before: friction on a
/// belt that comes to rest, or starts.
bool Run::change_resting_with_cells() {
  if (event_.cell_change == CellChange::none || holding_.guards().empty()) return false;
  RestingSurfaces resting;
  if (!find_resting(resting)) return true;
  std::set_difference(here_.state.resting.begin(), here_.state.resting.end(), resting.surfaces.begin(),
                      resting.surfaces.end(), std::back_inserter(event_.freed));
  return resting.surfaces != here_.state.resting;
}

/// Whether a jump of values has moved the zero of a guard at rest, or a contact, away from the state: a table that
/// drops, a belt that gets another speed. The guards are free then, and on the side where they are; contacts begin
/// anew.
bool Run::leaves_resting_with_cells() {
  if (event_.cell_change != CellChange::jump) return false;
  if (contacts_jump()) return true;
  if (holding_.guards().empty()) return false;
  std::vector<double> values(at(kernel_.event_functions())), magnitude(values.size()), slope(values.size());
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values.data());
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), magnitude.data(), slope.data());
  const auto resting = holding_.held().all();
  const bool stay = std::none_of(resting.begin(), resting.end(), [&](const HeldGuard& guard) {
    const auto function = at(guard.hold.function);
    return std::abs(values[function]) > 64.0 * rounding_unit * (magnitude[function] + slope[function]);
  });
  if (stay) return false;
  holding_.release_all();
  search_.set_held({});
  cascade_.drop_zeros();
  cascade_.read_user_signs();
  jumps_.update(jump_point());
  return true;
}

/// Surfaces that a released guard has kept at zero. The motion leaves them where it would if it had slid on them. It
/// goes to the side with whose selection nothing presses on the guard any more.
const ModeState& Run::slid_on_freed(SwitchingPoint& switching_point) {
  event_.slid = event_.before;
  for (const int j : event_.freed) {
    set_surface(event_.slid, j, 0, event_.before.alpha[at(j)]);
    std::erase(event_.slid.resting, j);
    switching_point.at_zero.push_back(j);
    switching_point.touched.push_back(j);
    (event_.before.alpha[at(j)] > 0.5 ? switching_point.exit_above : switching_point.exit_below).push_back(j);
  }
  drop_repeats(switching_point.at_zero);
  set_corner_alpha(event_.slid);
  return event_.slid;
}

}  // namespace saltus::event_integrator
