#include "saltus/event_integrator/instant/jump_stage.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/instant/contact_stage.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/mode/selections_at.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

/// Executions at one time before the run stops (rule 5).
constexpr std::size_t most_rounds = 10000;

/// Whether the conditions or values of jumps are wrong, which ends the run.
bool jumps_have_problem(RunState& run) {
  const auto reason = run.jumps.came_to_forbidden() ? Termination::outside_class : Termination::evaluation_failed;
  if (!run.jumps.problem().empty() && run.running) run.end(reason, run.jumps.problem());
  return !run.jumps.problem().empty();
}

/// Ends a run in which jumps trigger each other at one time without an end.
void end_by_rounds(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  std::vector<int> jumps;
  for (const auto& executed : cascade.executed().items().last(100)) {
    if (!contains(jumps, executed.jump)) jumps.push_back(executed.jump);
  }
  run.end(Termination::iteration_limit,
          fmt::format("{} jumps at t = {:.17g} without an end: {} trigger each other; make their conditions false by "
                      "what they set, or give one of them a delay",
                      most_rounds, run.here.t, jump_names(run.switching.layout, jumps)));
}

/// What contacts do behind an execution: those whose modes it ends, or all where it has moved bodies. Returns whether
/// they began anew; nullopt where the run ends.
std::optional<JumpCascade::Gaps> follow_contacts(const InstantContext& c, const ExecutedJump& executed) {
  auto& [run, cascade, out] = c;
  if (!run.contacts.owns(executed.jump)) {
    if (!run.contacts.are_moved(executed.x, run.here.x)) return JumpCascade::Gaps::kept;
    return begin_contacts_anew(c) ? std::optional(JumpCascade::Gaps::begun) : std::nullopt;
  }
  if (!move_contacts(c)) return std::nullopt;
  cascade.end_execution_of_contacts();
  return JumpCascade::Gaps::kept;
}

}  // namespace

std::string jump_names(const model::Layout& layout, const std::vector<int>& jumps) {
  std::string text;
  for (const int jump : jumps) text += (text.empty() ? "'" : ", '") + layout.jumps[at(jump)].name + "'";
  return text;
}

bool update_jumps(const InstantContext& c) {
  c.run.jumps.update(c.jump_point());
  return !jumps_have_problem(c.run);
}

namespace {

/// One execution: the state behind it, and what that triggers.
bool execute_jump(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  if (cascade.executed().size() >= most_rounds) {
    end_by_rounds(c);
    return false;
  }
  cascade.note_guards();
  ExecutedJump& executed = cascade.begin_execution(-1, run.here.x, run.contacts.activities());
  executed.jump = run.jumps.execute(c.jump_point(), run.here.x);
  cascade.end_execution();
  const auto gaps = follow_contacts(c, executed);
  if (!gaps) return false;
  auto& alpha = run.here.state.alpha;
  if (!run.cells.empty())
    out.cell_change = std::max(out.cell_change, run.cells.locate(run.here.t, run.here.x.data(), alpha));
  // What is left of a zero depends on the selections behind the jump.
  if (!alpha.empty()) alpha = selections_at(run.kernel, run.here.t, run.here.x.data(), alpha);
  cascade.drop_zeros();
  cascade.read_user_signs(*gaps);
  return update_jumps(c);
}

}  // namespace

bool execute_due_jumps(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  while (run.running && run.jumps.due(run.here.t)) {
    heed_stop();
    if (!execute_jump(c)) return false;
  }
  return run.running;
}

bool begin_jumps(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  if (run.jumps.none()) return true;
  ModeState& state = run.here.state;
  state.mode.assign(at(run.kernel.switching_functions()), 0);
  state.alpha.assign(state.mode.size(), 0.5);
  state.alpha = selections_at(run.kernel, run.here.t, run.here.x.data(), state.alpha);
  if (!begin_contacts(c)) return false;
  cascade.read_user_signs(JumpCascade::Gaps::begun);
  run.jumps.begin(c.jump_point());
  return !jumps_have_problem(run) && execute_due_jumps(c);
}

bool decide_behind_jumps(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  cascade.forget_motions();
  if (run.kernel.switching_functions() == 0) {  // nothing to decide
    cascade.transition().beside = run.here.x;
    return true;
  }
  std::vector<int> surfaces;
  for (const int function : run.ledger.zeros()) {
    if (function < run.kernel.switching_functions()) surfaces.push_back(function);
  }
  RestingSurfaces resting;
  if (!find_resting(c, resting)) return false;
  const Position& here = run.here;
  cascade.transition() =
      decide_behind_jump(run.switching, here.state, here.t, here.x.data(), here.time_scale, surfaces, resting);
  if (cascade.transition().termination == Termination::completed) return true;
  run.end(cascade.transition().termination, cascade.transition().message);
  return false;
}

bool check_behind_jumps(const InstantContext& c) {
  auto& [run, cascade, out] = c;
  if (const auto endless = cascade.endless_jump()) {
    run.end(Termination::outside_class,
            fmt::format("the jump {} at t = {:.17g} sets what it compares to the limit itself, and the motion passes "
                        "it again at once; state the limit in [dynamics], as x = \"if(x < limit, f, min(f, 0))\"",
                        jump_names(run.switching.layout, {*endless}), run.here.t));
    return false;
  }
  return contact_modes_hold(c);
}

}  // namespace saltus::event_integrator
