#include "saltus/event_integrator/instant/cell_stage.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"

namespace saltus::event_integrator {
namespace {

bool is_of_time(const RunState& run, int surface) {
  return run.switching.layout.surfaces[at(surface)].role == model::SwitchingRole::time_event;
}

/// Switching functions whose values time moves here: they hold constants of a cell that moved last, selections of a
/// function of time that is passed here, or selections of such functions.
std::vector<bool> functions_moved_by_time(const InstantContext& c) {
  const RunState& run = c.run;
  const auto& touched = c.out.switching_point.touched;
  const bool cells_move = c.out.cell_change != CellChange::none;
  std::vector<bool> moved(at(run.kernel.switching_functions()));
  for (int j = 0; j < run.kernel.switching_functions(); ++j) {
    const auto& inner = run.kernel.inner(j);  // of smaller indices
    const auto moves = [&](int i) { return moved[at(i)] || (is_of_time(run, i) && contains(touched, i)); };
    moved[at(j)] = (cells_move && run.cells.moved_in(j)) || std::any_of(inner.begin(), inner.end(), moves);
  }
  return moved;
}

std::string moved_names(const InstantContext& c) {
  const auto& layout = c.run.switching.layout;
  std::string names = c.run.cells.moved_names(layout);
  for (const int j : c.out.switching_point.touched) {
    if (is_of_time(c.run, j)) names += (names.empty() ? "" : ", ") + layout.surfaces[at(j)].name;
  }
  return names;
}

}  // namespace

bool reaches_cell_end(const EventSearch& search, const Located& located) {
  return std::any_of(located.functions.begin(), located.functions.end(),
                     [&](std::size_t i) { return is_cell_end(search.functions()[i].kind); });
}

CellChange leave_cells(const InstantContext& c, const Located& located) {
  auto& [run, cascade, out] = c;
  if (!reaches_cell_end(run.search, located)) return CellChange::none;
  const auto& functions = run.search.functions();
  const auto change =
      run.cells.leave(functions, located.functions, run.here.t, run.here.x.data(), run.here.state.alpha);
  for (const auto i : located.functions) {
    if (is_cell_end(functions[i].kind)) run.search.entered_cell(functions[i]);
  }
  return change;
}

Located breaks_here(RunState& run) {
  Located here{run.here.t, run.here.x, {}, {}};
  const auto& functions = run.search.functions();
  for (std::size_t i = 0; i < functions.size() && !run.cells.empty(); ++i) {
    if (!run.cells.jumps_at(functions[i], run.here.t, run.here.x.data(), run.here.state.alpha)) continue;
    here.functions.push_back(i);
    here.signs.push_back(functions[i].sign);
  }
  return here;
}

bool time_moves_surfaces(const InstantContext& c) {
  if (!c.out.before.higher) return false;  // what is slid on is decided with the surfaces inside it
  const auto moved = functions_moved_by_time(c);
  const auto& at_zero = c.out.switching_point.at_zero;
  return std::any_of(at_zero.begin(), at_zero.end(), [&](int j) { return moved[at(j)]; });
}

bool decide_behind_times(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  std::vector<int> held, slid;
  const auto moved = functions_moved_by_time(c);
  for (const int j : out.before.sliding) (moved[at(j)] ? slid : held).push_back(j);
  for (const auto* others : {&out.freed, &out.switching_point.touched}) {
    for (const int j : *others) {
      if (!moved[at(j)] && !contains(held, j)) held.push_back(j);
    }
  }
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return false;
  Transition& transition = out.transition;
  const Position& here = run.here;
  transition =
      decide_behind_jump(run.switching, out.before, here.t, here.x.data(), here.time_scale, held, resting, slid);
  if (transition.termination == result::Termination::completed && transition.state.mode != out.before.mode) {
    transition.reason = (transition.reason.empty() ? "" : transition.reason + "; ") + "signs after the " +
                        (out.cell_change == CellChange::kink ? "kink of " : "jump of ") + moved_names(c);
  }
  run.ledger.forget_users();
  return true;
}

bool find_undefined_cells(RunState& run) {
  if (!run.cells.any_undefined()) return false;
  const Position& here = run.here;
  std::vector<double> ahead = here.x;
  for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] += 8.0 * here.smallest_step() * here.slope[i];
  const auto change = std::max(run.cells.locate_undefined(here.t, here.x.data(), here.state.alpha),
                               run.cells.locate_undefined(here.t, ahead.data(), here.state.alpha));
  return change != CellChange::none;
}

}  // namespace saltus::event_integrator
