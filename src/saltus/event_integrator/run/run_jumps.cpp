// Jumps at one time: the cascade of executions, the mode behind it, guards that stay at zero.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"
#include "saltus/event_integrator/mode/selections_at.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

/// Executions at one time before the run stops (rule 5).
constexpr std::size_t most_rounds = 10000;

}  // namespace

std::string Run::jump_names(const std::vector<int>& jumps) const {
  std::string text;
  for (const int jump : jumps)
    text += (text.empty() ? "'" : ", '") + switching_context_.layout.jumps[at(jump)].name + "'";
  return text;
}

bool Run::jumps_have_problem() {
  const auto reason = jumps_.came_to_forbidden() ? Termination::outside_class : Termination::evaluation_failed;
  if (!jumps_.problem().empty() && outcome_.running) fail(reason, jumps_.problem());
  return !jumps_.problem().empty();
}

/// One execution: the state behind it, and what that triggers.
bool Run::execute_jump() {
  if (cascade_.executed().size() >= most_rounds) {
    std::vector<int> jumps;
    for (const auto& executed : cascade_.executed().items().last(100)) {
      if (!contains(jumps, executed.jump)) jumps.push_back(executed.jump);
    }
    fail(Termination::iteration_limit,
         fmt::format("{} jumps at t = {:.17g} without an end: {} trigger each other; make their conditions false by "
                     "what they set, or give one of them a delay",
                     most_rounds, here_.t, jump_names(jumps)));
    return false;
  }
  cascade_.note_guards();
  ExecutedJump& executed = cascade_.executed().append();
  executed.x = here_.x;
  executed.jump = jumps_.execute(jump_point(), here_.x);
  executed.x_after = here_.x;
  executed.why_open.clear();
  const bool by_contact = contacts_.owns(executed.jump);
  const bool are_begun = !by_contact && contacts_.are_moved(executed.x, here_.x);
  if (by_contact ? !move_contacts() : are_begun && !begin_contacts_anew()) return false;
  if (by_contact) {
    executed.x_after = here_.x;
    executed.why_open = contacts_.why_open();
  }
  if (!cells_.empty())
    event_.cell_change = std::max(event_.cell_change, cells_.locate(here_.t, here_.x.data(), here_.state.alpha));
  // What is left of a zero depends on the selections behind the jump.
  if (!here_.state.alpha.empty())
    here_.state.alpha = selections_at(kernel_, here_.t, here_.x.data(), here_.state.alpha);
  cascade_.drop_zeros();
  cascade_.read_user_signs(are_begun ? JumpCascade::Gaps::begun : JumpCascade::Gaps::kept);
  jumps_.update(jump_point());
  return !jumps_have_problem();
}

/// The mode afresh, as at a start (rule 6).
bool Run::decide_behind_jumps() {
  cascade_.forget_motions();
  if (kernel_.switching_functions() == 0) {  // nothing to decide
    cascade_.transition().beside = here_.x;
    return enter(cascade_.transition());
  }
  std::vector<int> surfaces;
  for (const int function : cascade_.zeros()) {
    if (function < kernel_.switching_functions()) surfaces.push_back(function);
  }
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  cascade_.transition() =
      decide_behind_jump(switching_context_, here_.state, here_.t, here_.x.data(), here_.time_scale, surfaces, resting);
  if (cascade_.transition().termination != Termination::completed) {
    fail(cascade_.transition().termination, cascade_.transition().message);
    return false;
  }
  choices_.choose(cascade_.transition(), progress());
  return enter(cascade_.transition());
}

/// User functions whose kinks are among the surfaces touched here.
std::vector<std::size_t> Run::with_kinks_here(const std::vector<int>& touched) const {
  std::vector<std::size_t> found;
  const auto& functions = search_.functions();
  for (std::size_t place = 0; place < functions.size(); ++place) {
    if (functions[place].kind != FunctionKind::user) continue;
    const auto& inner = kernel_.inner(functions[place].index);
    const bool has_kink = std::any_of(touched.begin(), touched.end(), [&](int j) { return contains(inner, j); });
    if (has_kink) found.push_back(place);
  }
  return found;
}

/// What was located passes nothing where the mode behind keeps it at zero, or leads it back. Conditions that compare
/// what is slid on from here are at equality. A function with a kink at its zero takes the side of the mode behind.
void Run::turn_by_mode_behind(const Located& located) {
  const auto& functions = search_.functions();
  SwitchingPoint point;
  point.begin(here_.t, here_.x.data(), here_.time_scale);
  std::vector<std::size_t> compared;
  for (const std::size_t place : located.functions) {
    const auto& function = functions[place];
    if (function.kind == FunctionKind::surface) point.touched.push_back(function.index);
    const bool user = function.kind == FunctionKind::user;
    if (user && (jumps_.is_compared(function.index) || user_events_.is_compared(function.index)))
      compared.push_back(place);
  }
  if (point.touched.empty() || search_.user_signs().empty()) return;
  auto turning = with_kinks_here(point.touched);
  std::erase_if(turning,
                [&](std::size_t place) { return functions[place].sign != 0 && !contains(located.functions, place); });
  if (compared.empty() && turning.empty()) return;
  std::sort(point.touched.begin(), point.touched.end());
  point.at_zero = here_.state.sliding;
  point.at_zero.insert(point.at_zero.end(), point.touched.begin(), point.touched.end());
  std::sort(point.at_zero.begin(), point.at_zero.end());
  const Transition next = decide_mode(switching_context_, here_.state, point);
  if (next.termination != Termination::completed) return;
  const auto turn = [&](std::size_t place, int sign) { search_.set_user_sign(place, sign, here_.t, here_.x.data()); };
  for (const std::size_t place : turning) {
    turn(place, side_ahead(switching_context_, next.state, point, here_.x, functions[place].index));
  }
  for (const std::size_t place : compared) {
    if (is_kept_by_sliding(kernel_, next.state, functions[place].index, here_.t, here_.x.data())) turn(place, 0);
  }
}

/// Executes everything that is due at here_.t, with all that follows at once; the mode behind is in force then.
bool Run::settle_jumps() {
  do {
    while (outcome_.running && jumps_.due(here_.t)) {
      if (!execute_jump()) return false;
    }
    if (!decide_behind_jumps()) return false;
    if (hold_resting() && !decide_behind_jumps()) return false;
    if (!outcome_.running) return false;
    cascade_.give_directions();
    jumps_.update(jump_point());
    if (jumps_have_problem()) return false;
  } while (jumps_.due(here_.t));
  if (const auto endless = cascade_.endless_jump()) {
    fail(Termination::outside_class,
         fmt::format("the jump {} at t = {:.17g} sets what it compares to the limit itself, and the motion passes it "
                     "again at once; state the limit in [dynamics], as x = \"if(x < limit, f, min(f, 0))\"",
                     jump_names({*endless}), here_.t));
    return false;
  }
  if (!contact_modes_hold()) return false;
  if (!cascade_.executed().empty()) cascade_.executed().back().x_after = here_.x;
  return true;
}

/// Rules 4 to 6 at an event: user events of the motion before, the jumps, user events by them.
bool Run::jump(const ModeState& before, const std::vector<double>& x_before) {
  event_.jumped = true;
  const auto fired = fire_user_events(here_.x, before);
  const Termination stopped = outcome_.result.status.termination;
  const std::string message = outcome_.result.status.message;
  outcome_.running = true;  // an event that stops the run lets the jumps of its time happen
  cascade_.note_guards();
  if (!cascade_.held_before().empty()) {
    holding_.release_all();
    search_.set_held({});
  }
  const bool settled = settle_jumps();
  const bool slips_on = only_slips_on();
  if (!slips_on) {
    cascade_.transition().state = here_.state;
    recorder_.jumped(here_.t, cascade_.executed().items(), &before, cascade_.transition());
  }
  if (!settled) return false;
  if (!cascade_.resting().empty()) {
    recorder_.accumulated(here_.t, cascade_.resting(), {here_.x, here_.x, here_.state, here_.state}, resting_reason);
  }
  if (stopped != Termination::completed) fail(stopped, message);
  fire_user_events(x_before, before, fired);
  if (!slips_on) jump_accumulation_.note(cascade_, jumps_, search_.user_signs());
  start_step();
  static_cast<void>(steps_.memory().change(here_.state.mode, here_.t,
                                           here_.h));  // the mode lasts from here; its step is that of a start
  return outcome_.running;
}

/// A time at which jumps are due, reached by a step that ended exactly there.
Run::Step Run::jump_in_time() {
  const Arrival arrival =
      arrive(recorder_.ends_at(here_.t) ? OutputRows::Arrival::written : OutputRows::Arrival::missing);
  cascade_.begin();
  jumps_.update(jump_point());
  if (jumps_have_problem()) return depart(arrival);
  if (!jumps_.due(here_.t)) return Step::taken;
  static_cast<void>(jump(event_.before, event_.x_before));
  return depart(arrival);
}

/// Rule 3, before the first mode is decided.
bool Run::begin_jumps() {
  if (jumps_.none()) return true;
  here_.state.mode.assign(at(kernel_.switching_functions()), 0);
  here_.state.alpha.assign(here_.state.mode.size(), 0.5);
  here_.state.alpha = selections_at(kernel_, here_.t, here_.x.data(), here_.state.alpha);
  if (!begin_contacts()) return false;
  cascade_.read_user_signs(JumpCascade::Gaps::begun);
  jumps_.begin(jump_point());
  if (jumps_have_problem()) return false;
  while (jumps_.due(here_.t)) {
    if (!execute_jump()) return false;
  }
  return true;
}

/// Guards at zero at the start, and what they trigger by moving on.
bool Run::settle_at_start() {
  if (jumps_.none()) return true;
  if (hold_resting() && !decide_behind_jumps()) return false;
  if (!outcome_.running) return false;
  cascade_.give_directions();
  jumps_.update(jump_point());
  if (jumps_have_problem()) return false;
  if (jumps_.due(here_.t) && !settle_jumps()) return false;
  cascade_.transition().state = here_.state;
  if (!cascade_.executed().empty()) cascade_.executed().back().x_after = here_.x;
  jump_accumulation_.note(cascade_, jumps_, search_.user_signs());
  return true;
}

/// A step as at a start: from the field of the continuous states alone, not beyond the last cycle of a shrinking
/// sequence of jumps.
void Run::start_step() {
  here_.h = steps_.initial_step();
  if (const auto cycle = jump_accumulation_.last_cycle()) here_.h = std::min(here_.h, *cycle);
  std::vector<double> free_slope(here_.x.size());
  field_(here_.t, here_.x.data(), free_slope.data());  // selections back to those of this point
}

}  // namespace saltus::event_integrator
