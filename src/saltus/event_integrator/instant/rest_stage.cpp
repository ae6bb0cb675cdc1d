#include "saltus/event_integrator/instant/rest_stage.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"
#include "saltus/event_integrator/instant/contact_stage.hpp"

namespace saltus::event_integrator {

using result::Termination;

bool find_resting(const InstantContext& c, RestingSurfaces& resting) {
  resting = find_resting_surfaces(c.run.switching, c.run.holding, c.run.here.t, c.run.here.state.alpha, c.run.here.x);
  if (c.run.contacts.hold(c.run.here.x))
    add_kept_by_contacts(c.run.switching, c.run.contacts, c.run.here.t, c.run.here.state.alpha, c.run.here.x, resting);
  if (resting.problem.empty()) return true;
  c.run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", c.run.here.t, resting.problem));
  return false;
}

bool hold_guards(const InstantContext& c, std::vector<HeldGuard> guards, std::vector<HeldGuard> loose) {
  for (const auto* list : {&guards, &loose}) {
    for (const auto& guard : *list) {
      c.cascade.add_zero(guard.hold.function);
    }
  }
  if (const auto problem =
          c.run.holding.hold(std::move(guards), std::move(loose), c.run.here.t, c.run.here.state.alpha, c.run.here.x)) {
    c.run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", c.run.here.t, *problem));
    return false;
  }
  c.run.search.set_held(c.run.holding.held());
  c.cascade.read_user_signs();
  return true;
}

bool hold_resting(const InstantContext& c) {
  auto [guards, loose] = c.cascade.pressed_guards();
  const auto is_in = [](const std::vector<HeldGuard>& list, const HeldGuard& guard) {
    return std::any_of(list.begin(), list.end(),
                       [&](const HeldGuard& other) { return other.hold.function == guard.hold.function; });
  };
  const auto was_executed = [&](int jump) {
    const auto items = c.cascade.executed().items();
    return std::any_of(items.begin(), items.end(), [&](const auto& executed) { return executed.jump == jump; });
  };
  const auto kept = c.cascade.guards_kept_by_sliding({guards, loose});
  guards.insert(guards.end(), kept.begin(), kept.end());
  if (guards.empty()) return false;
  for (const auto& guard : guards) {
    const int jump = guard.hold.jump;
    if (is_in(c.cascade.held_before(), guard) || !was_executed(jump) || contains(c.cascade.resting(), jump)) continue;
    c.cascade.resting().push_back(jump);
  }
  return hold_guards(c, std::move(guards), std::move(loose));
}

bool free_passing(const InstantContext& c) {
  auto guards = c.run.holding.held().all();
  const auto passed = std::erase_if(guards, [&](const HeldGuard& guard) {
    return !c.run.holding.can_rest(guard, c.run.here.t, c.run.here.state.alpha, c.run.here.x);
  });
  if (passed == 0) return true;
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return false;
  for (const int j : resting.surfaces) c.cascade.add_zero(j);
  return hold_guards(c, std::move(guards), {});
}

bool change_resting_with_cells(const InstantContext& c) {
  if (c.out.cell_change == CellChange::none || c.run.holding.guards().empty()) return false;
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return true;
  std::set_difference(c.run.here.state.resting.begin(), c.run.here.state.resting.end(), resting.surfaces.begin(),
                      resting.surfaces.end(), std::back_inserter(c.out.freed));
  return resting.surfaces != c.run.here.state.resting;
}

bool leaves_resting_with_cells(const InstantContext& c) {
  if (c.out.cell_change != CellChange::jump) return false;
  if (contacts_jump(c)) return true;
  if (c.run.holding.guards().empty()) return false;
  std::vector<double> values(at(c.run.kernel.event_functions())), magnitude(values.size()), slope(values.size());
  c.run.kernel.functions(c.run.here.t, c.run.here.x.data(), c.run.here.state.alpha.data(), values.data());
  c.run.kernel.scales(c.run.here.t, c.run.here.x.data(), c.run.here.state.alpha.data(), magnitude.data(), slope.data());
  const auto resting = c.run.holding.held().all();
  const bool stay = std::none_of(resting.begin(), resting.end(), [&](const HeldGuard& guard) {
    const auto function = at(guard.hold.function);
    return std::abs(values[function]) > 64.0 * rounding_unit * (magnitude[function] + slope[function]);
  });
  if (stay) return false;
  c.run.holding.release_all();
  c.run.search.set_held({});
  c.cascade.drop_zeros();
  c.cascade.read_user_signs();
  c.run.jumps.update(c.jump_point());
  return true;
}

const ModeState& slid_on_freed(const InstantContext& c) {
  SwitchingPoint& switching_point = c.out.switching_point;
  c.out.slid = c.out.before;
  for (const int j : c.out.freed) {
    set_surface(c.out.slid, j, 0, c.out.before.alpha[at(j)]);
    std::erase(c.out.slid.resting, j);
    switching_point.at_zero.push_back(j);
    switching_point.touched.push_back(j);
    (c.out.before.alpha[at(j)] > 0.5 ? switching_point.exit_above : switching_point.exit_below).push_back(j);
  }
  drop_repeats(switching_point.at_zero);
  set_corner_alpha(c.out.slid);
  return c.out.slid;
}

bool release(const InstantContext& c, const Located& located) {
  c.out.freed.clear();
  if (c.run.holding.guards().empty()) return false;
  std::vector<HeldGuard> guards = c.run.holding.guards();
  auto signs = c.run.search.user_signs();
  std::vector<bool> vanish(signs.size(), false);
  std::vector<int> orders(signs.size(), 1);
  for (const auto function : located.functions) {
    const auto& entry = c.run.search.functions()[function];
    if (entry.kind == FunctionKind::user) vanish[at(entry.index - c.run.kernel.switching_functions())] = true;
    if (entry.kind != FunctionKind::release) continue;
    std::erase_if(guards, [&](const HeldGuard& guard) { return guard.hold.function == entry.index; });
  }
  if (guards.size() == c.run.holding.guards().size()) return false;
  const auto before = c.run.holding.held().all();
  const auto problem = c.run.holding.hold(std::move(guards), c.run.holding.held().followers, c.run.here.t,
                                          c.run.here.state.alpha, c.run.here.x);
  if (problem) c.run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", c.run.here.t, *problem));
  for (const auto& guard : before) {
    if (c.run.holding.holds(guard.hold.function)) continue;
    // It moves outward from here, whatever the roundings of its derivatives say.
    const auto user = at(guard.hold.function - c.run.kernel.switching_functions());
    signs[user] = -guard.inward;
    vanish[user] = true;
    orders[user] = 2;  // at least: nothing presses on it
  }
  c.run.search.set_held(c.run.holding.held());
  c.run.search.set_user_signs(signs, vanish, orders);
  RestingSurfaces resting;
  if (!c.run.here.state.resting.empty() && find_resting(c, resting)) {
    std::set_difference(c.run.here.state.resting.begin(), c.run.here.state.resting.end(), resting.surfaces.begin(),
                        resting.surfaces.end(), std::back_inserter(c.out.freed));
  }
  return true;
}

}  // namespace saltus::event_integrator
