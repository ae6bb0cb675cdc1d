// Guards of jumps at rest: which are held, and which surfaces they keep at zero.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

}  // namespace

/// The surfaces that the held guards keep at zero; false if these cannot be followed, with the status set.
bool Run::find_resting(RestingSurfaces& resting) {
  resting = find_resting_surfaces(surroundings_, holding_, here_.t, here_.state.alpha, here_.x);
  if (resting.problem.empty()) return true;
  fail(Termination::outside_class, fmt::format("at t = {:.17g} {}", here_.t, resting.problem));
  return false;
}

/// The surfaces that keep a guard at zero at rest by sliding: with other selections of theirs it would leave. None if
/// the guard is not kept so.
std::vector<int> Run::surfaces_keeping(int function) {
  if (here_.state.sliding.empty()) return {};
  const auto bend = [&](const std::vector<double>& alpha) {
    return kernel_.lie_derivative(function, 2, here_.t, here_.x.data(), alpha.data());
  };
  std::vector<int> surfaces;
  double range = 0.0;
  for (const int j : here_.state.sliding) {
    auto alpha = here_.state.alpha;
    alpha[at(j)] = 0.0;
    const double below = bend(alpha);
    alpha[at(j)] = 1.0;
    const double change = std::abs(bend(alpha) - below);
    range += change;
    if (change > 0.0) surfaces.push_back(j);
  }
  // As for selections that move nothing.
  return std::abs(bend(field_.alpha())) <= 1e-9 * range ? surfaces : std::vector<int>{};
}

/// Guards at zero that what slides keeps at rest: they are held as well, so that nothing has to be asked where sliding
/// ends and the guard takes over. None where the guards alone do not keep all of that at zero.
std::vector<HeldGuard> Run::guards_kept_by_sliding(Landing& landing, const RestingGuards& others) {
  std::vector<HeldGuard> kept;
  std::vector<int> surfaces;
  if (here_.state.sliding.empty() || !holding_.guards().empty()) return kept;
  const auto& vanish = search_.user_zeros();
  for (int jump = 0; jump < static_cast<int>(surroundings_.system.jumps.size()); ++jump) {
    if (contacts_.owns(jump)) continue;
    for (int g = 0; g < static_cast<int>(surroundings_.system.jumps[at(jump)].guards.numel()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      if (!vanish[at(function - kernel_.switching_functions())] || jumps_.is_discrete_guard(function)) continue;
      const Motion motion = motion_of(function, landing);
      const int inward = jumps_.trigger_sign(jump, g, jump_point(), static_cast<int>(motion.side.drift));
      if (motion.order == 1 || inward == 0) continue;
      const auto own = surfaces_keeping(function);
      if (own.empty() || !holding_.can_rest({{jump, function}, inward}, here_.t, here_.state.alpha, here_.x)) continue;
      kept.push_back({{jump, function}, inward});
      surfaces.insert(surfaces.end(), own.begin(), own.end());
    }
  }
  if (kept.empty()) return kept;
  auto guards = others.held;
  guards.insert(guards.end(), kept.begin(), kept.end());
  auto x = here_.x;
  const bool held = !holding_.hold(std::move(guards), others.loose, here_.t, here_.state.alpha, x);
  const auto resting =
      held ? find_resting_surfaces(surroundings_, holding_, here_.t, here_.state.alpha, x) : RestingSurfaces{};
  holding_.release_all();
  const bool kept_by_guards =
      std::all_of(surfaces.begin(), surfaces.end(), [&](int j) { return contains(resting.surfaces, j); });
  if (!resting.problem.empty() || !kept_by_guards) kept.clear();
  return kept;
}

/// Guards of executed jumps, and those held before, that were left at zero without a velocity and are pressed on.
Run::RestingGuards Run::pressed_guards(Landing& landing) {
  RestingGuards guards;
  std::vector<int> jumps;
  for (const auto& executed : landing.executed.items()) {
    if (!contains(jumps, executed.jump)) jumps.push_back(executed.jump);
  }
  for (const auto& guard : landing.held_before) {
    if (!contains(jumps, guard.hold.jump)) jumps.push_back(guard.hold.jump);
  }
  const auto& vanish = search_.user_zeros();
  for (const int jump : jumps) {
    if (contacts_.owns(jump)) continue;
    for (int g = 0; g < static_cast<int>(surroundings_.system.jumps[at(jump)].guards.numel()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      const bool at_zero = vanish[at(function - kernel_.switching_functions())];
      if (!at_zero || jumps_.is_discrete_guard(function)) continue;
      // The derivatives along fixed selections are not those of a motion that slides.
      if (!surfaces_keeping(function).empty()) continue;
      const Motion motion = motion_of(function, landing);
      const int drift = static_cast<int>(motion.side.drift);
      const int inward = jumps_.trigger_sign(jump, g, jump_point(), drift);
      if (motion.order < 2 || inward == 0 || drift != inward) continue;
      const HeldGuard guard{{jump, function}, inward};
      (holding_.can_rest(guard, here_.t, here_.state.alpha, here_.x) ? guards.held : guards.loose).push_back(guard);
    }
  }
  return guards;
}

/// Holds the guards at rest. Returns whether the field has changed.
bool Run::hold_resting(Landing& landing) {
  auto [guards, loose] = pressed_guards(landing);
  const auto is_in = [](const std::vector<HeldGuard>& list, const HeldGuard& guard) {
    return std::any_of(list.begin(), list.end(),
                       [&](const HeldGuard& other) { return other.hold.function == guard.hold.function; });
  };
  const auto was_executed = [&](int jump) {
    const auto items = landing.executed.items();
    return std::any_of(items.begin(), items.end(), [&](const auto& executed) { return executed.jump == jump; });
  };
  const auto kept = guards_kept_by_sliding(landing, {guards, loose});
  guards.insert(guards.end(), kept.begin(), kept.end());
  if (guards.empty()) return false;
  for (const auto& guard : guards) {
    const int jump = guard.hold.jump;
    if (is_in(landing.held_before, guard) || !was_executed(jump) || contains(landing.resting, jump)) continue;
    landing.resting.push_back(jump);
  }
  return hold(std::move(guards), std::move(loose), landing);
}

/// Puts the state on the guards and keeps it there; false if that fails, with the status set.
bool Run::hold(std::vector<HeldGuard> guards, std::vector<HeldGuard> loose, Landing& landing) {
  for (const auto* list : {&guards, &loose}) {
    for (const auto& guard : *list) {
      if (!contains(landing.zeros, guard.hold.function)) landing.zeros.push_back(guard.hold.function);
    }
  }
  if (const auto problem = holding_.hold(std::move(guards), std::move(loose), here_.t, here_.state.alpha, here_.x)) {
    fail(Termination::outside_class, fmt::format("at t = {:.17g} {}", here_.t, *problem));
    return false;
  }
  search_.set_held(holding_.guards(), holding_.followers());
  read_user_signs(landing);
  return true;
}

/// Guards at a limit whose jumps let a motion go on: the state is at rest on them, and what slides, if anything, keeps
/// it there. false if the others cannot be held, with the status set.
bool Run::free_passing(Landing& landing) {
  auto guards = holding_.resting();
  const auto passed = std::erase_if(
      guards, [&](const HeldGuard& guard) { return !holding_.can_rest(guard, here_.t, here_.state.alpha, here_.x); });
  if (passed == 0) return true;
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  landing.zeros.insert(landing.zeros.end(), resting.surfaces.begin(), resting.surfaces.end());
  return hold(std::move(guards), {}, landing);
}

/// Guards that were kept at zero by what slid, and are left in the mode that was entered here: they get the sign to
/// which they go, at this time and not where it is seen first.
void Run::leave_guards(Landing& landing) {
  auto signs = search_.user_signs();
  auto vanish = search_.user_zeros();
  std::vector<int> orders(signs.size(), 1);
  bool any = false;
  for (int jump = 0; jump < static_cast<int>(surroundings_.system.jumps.size()); ++jump) {
    if (contacts_.owns(jump)) continue;
    for (int g = 0; g < static_cast<int>(surroundings_.system.jumps[at(jump)].guards.numel()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      const auto user = at(function - kernel_.switching_functions());
      if (signs[user] != 0 || holding_.holds(function) || jumps_.is_discrete_guard(function)) continue;
      const int side = side_ahead(surroundings_, here_.state, at_this_time(), here_.x, function);
      if (side == 0) continue;
      if (!contains(landing.zeros, function)) landing.zeros.push_back(function);
      signs[user] = side;
      vanish[user] = true;
      orders[user] = 2;  // at least: its rate was held at 0
      any = true;
    }
  }
  if (!any) return;
  search_.set_user_signs(signs, vanish, orders);
  search_.enter(here_.state, transition_.zero_order, here_.t, here_.x.data());
}

/// Whether in the cells that were entered the guards at rest keep other surfaces at zero than before: friction on a
/// belt that comes to rest, or starts.
bool Run::change_resting_with_cells() {
  if (cell_change_ == CellChange::none || holding_.guards().empty()) return false;
  RestingSurfaces resting;
  if (!find_resting(resting)) return true;
  std::set_difference(here_.state.resting.begin(), here_.state.resting.end(), resting.surfaces.begin(),
                      resting.surfaces.end(), std::back_inserter(freed_));
  return resting.surfaces != here_.state.resting;
}

/// Surfaces that a released guard has kept at zero: the motion leaves them where it would if it had slid on them, to
/// the side with whose selection nothing presses on the guard any more.
const ModeState& Run::slid_on_freed(Occasion& occasion) {
  slid_ = before_;
  for (const int j : freed_) {
    set_surface(slid_, j, 0, before_.alpha[at(j)]);
    std::erase(slid_.resting, j);
    occasion.at_zero.push_back(j);
    occasion.touched.push_back(j);
    (before_.alpha[at(j)] > 0.5 ? occasion.exit_above : occasion.exit_below).push_back(j);
  }
  set_corner_alpha(slid_);
  return slid_;
}

}  // namespace saltus::event_integrator
