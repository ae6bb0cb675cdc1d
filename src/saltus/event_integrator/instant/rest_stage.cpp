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
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  resting = find_resting_surfaces(run.switching, run.holding, here.t, here.state.alpha, here.x);
  if (run.contacts.hold()) add_kept_by_contacts(run.switching, run.contacts, here.t, here.state.alpha, here.x, resting);
  if (resting.problem.empty()) return true;
  run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", here.t, resting.problem));
  return false;
}

bool hold_guards(const InstantContext& c, std::vector<HeldGuard> guards, std::vector<HeldGuard> loose) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  for (const auto* list : {&guards, &loose}) {
    for (const auto& guard : *list) run.ledger.add(guard.hold.function);
  }
  if (const auto problem = run.holding.hold(std::move(guards), std::move(loose), here.t, here.state.alpha, here.x)) {
    run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", here.t, *problem));
    return false;
  }
  run.search.set_held(run.holding.held());
  cascade.read_user_signs();
  return true;
}

bool hold_resting(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  auto [guards, loose] = cascade.pressed_guards();
  const auto is_in = [](const std::vector<HeldGuard>& list, const HeldGuard& guard) {
    return std::any_of(list.begin(), list.end(),
                       [&](const HeldGuard& other) { return other.hold.function == guard.hold.function; });
  };
  const auto was_executed = [&](int jump) {
    const auto items = cascade.executed().items();
    return std::any_of(items.begin(), items.end(), [&](const auto& executed) { return executed.jump == jump; });
  };
  const auto kept = cascade.guards_kept_by_sliding({guards, loose});
  guards.insert(guards.end(), kept.begin(), kept.end());
  if (guards.empty()) return false;
  for (const auto& guard : guards) {
    const int jump = guard.hold.jump;
    if (is_in(cascade.held_before(), guard) || !was_executed(jump) || contains(cascade.resting(), jump)) continue;
    cascade.resting().push_back(jump);
  }
  return hold_guards(c, std::move(guards), std::move(loose));
}

bool free_passing(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  auto guards = run.holding.held().all();
  const auto passed = std::erase_if(
      guards, [&](const HeldGuard& guard) { return !run.holding.can_rest(guard, here.t, here.state.alpha, here.x); });
  if (passed == 0) return true;
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return false;
  for (const int j : resting.surfaces) run.ledger.add(j);
  return hold_guards(c, std::move(guards), {});
}

bool change_resting_with_cells(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  if (out.cell_change == CellChange::none || run.holding.guards().empty()) return false;
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return true;
  std::set_difference(here.state.resting.begin(), here.state.resting.end(), resting.surfaces.begin(),
                      resting.surfaces.end(), std::back_inserter(out.freed));
  return resting.surfaces != here.state.resting;
}

bool leaves_resting_with_cells(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  if (out.cell_change != CellChange::jump) return false;
  if (contacts_jump(c)) return true;
  if (run.holding.guards().empty()) return false;
  std::vector<double> values(at(run.kernel.event_functions())), magnitude(values.size()), slope(values.size());
  run.kernel.functions(here.t, here.x.data(), here.state.alpha.data(), values.data());
  run.kernel.scales(here.t, here.x.data(), here.state.alpha.data(), magnitude.data(), slope.data());
  const auto resting = run.holding.held().all();
  const bool stay = std::none_of(resting.begin(), resting.end(), [&](const HeldGuard& guard) {
    const auto function = at(guard.hold.function);
    return std::abs(values[function]) > 64.0 * rounding_unit * (magnitude[function] + slope[function]);
  });
  if (stay) return false;
  run.holding.release_all();
  run.search.set_held({});
  cascade.drop_zeros();
  cascade.read_user_signs();
  run.jumps.update(c.jump_point());
  return true;
}

const ModeState& slid_on_freed(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  SwitchingPoint& switching_point = out.switching_point;
  out.slid = out.before;
  for (const int j : out.freed) {
    set_surface(out.slid, j, 0, out.before.alpha[at(j)]);
    std::erase(out.slid.resting, j);
    switching_point.at_zero.push_back(j);
    switching_point.touched.push_back(j);
    (out.before.alpha[at(j)] > 0.5 ? switching_point.exit_above : switching_point.exit_below).push_back(j);
  }
  drop_repeats(switching_point.at_zero);
  set_corner_alpha(out.slid);
  return out.slid;
}

bool release(const InstantContext& c, const Located& located) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  out.freed.clear();
  if (run.holding.guards().empty()) return false;
  std::vector<HeldGuard> guards = run.holding.guards();
  for (const auto function : located.functions) {
    const auto& entry = run.search.functions()[function];
    if (entry.kind != FunctionKind::release) continue;
    std::erase_if(guards, [&](const HeldGuard& guard) { return guard.hold.function == entry.index; });
  }
  if (guards.size() == run.holding.guards().size()) return false;
  const auto before = run.holding.held().all();
  const auto problem =
      run.holding.hold(std::move(guards), run.holding.held().followers, here.t, here.state.alpha, here.x);
  if (problem) run.end(Termination::outside_class, fmt::format("at t = {:.17g} {}", here.t, *problem));
  for (const auto& guard : before) {
    if (run.holding.holds(guard.hold.function)) continue;
    // It moves outward from here, whatever the roundings of its derivatives say.
    run.ledger.put(guard.hold.function, -guard.inward, 2);  // at least: nothing presses on it
  }
  run.search.set_held(run.holding.held());
  RestingSurfaces resting;
  if (!here.state.resting.empty() && find_resting(c, resting)) {
    std::set_difference(here.state.resting.begin(), here.state.resting.end(), resting.surfaces.begin(),
                        resting.surfaces.end(), std::back_inserter(out.freed));
  }
  return true;
}

}  // namespace saltus::event_integrator
