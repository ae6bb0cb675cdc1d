#include "saltus/event_integrator/instant/cell_stage.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"

namespace saltus::event_integrator {
namespace {

/// Switching functions that hold constants of a cell that moved last, or selections of such functions.
std::vector<bool> functions_in_moved_cells(const RunState& run) {
  std::vector<bool> moved(at(run.kernel.switching_functions()));
  for (int j = 0; j < run.kernel.switching_functions(); ++j) {
    const auto& inner = run.kernel.inner(j);  // of smaller indices
    moved[at(j)] =
        run.cells.moved_in(j) || std::any_of(inner.begin(), inner.end(), [&](int i) { return moved[at(i)]; });
  }
  return moved;
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

bool decide_in_cells(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  std::vector<int> held, slid;
  const auto moved = functions_in_moved_cells(run);
  for (const int j : out.before.sliding) (moved[at(j)] ? slid : held).push_back(j);
  held.insert(held.end(), out.freed.begin(), out.freed.end());
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return false;
  Transition& transition = out.transition;
  const Position& here = run.here;
  transition =
      decide_behind_jump(run.switching, out.before, here.t, here.x.data(), here.time_scale, held, resting, slid);
  if (transition.termination == result::Termination::completed && transition.state.mode != out.before.mode) {
    transition.reason = (transition.reason.empty() ? "" : transition.reason + "; ") + "signs behind the " +
                        (out.cell_change == CellChange::jump ? "jump of " : "kink of ") +
                        run.cells.moved_names(run.switching.layout);
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
