// Jumps at one time: the cascade of executions, the mode behind it, guards that stay at zero.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

/// Executions at one time before the run stops (rule 5).
constexpr std::size_t most_rounds = 10000;

}  // namespace

std::string Run::jump_names(const std::vector<int>& jumps) const {
  std::string text;
  for (const int jump : jumps) text += (text.empty() ? "'" : ", '") + surroundings_.system.jumps[at(jump)].name + "'";
  return text;
}

bool Run::jumps_have_problem() {
  if (!jumps_.problem().empty() && running_) fail(Termination::evaluation_failed, jumps_.problem());
  return !jumps_.problem().empty();
}

/// All functions of the kernel here.
void Run::find_values() {
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values_.value.data());
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), values_.magnitude.data(), values_.slope.data());
}

/// At a point where only the surfaces of the sliding mode are at zero. Valid until the next one is made.
Run::Landing& Run::landing_here() {
  Landing& landing = landing_;
  if (jumps_.none()) return landing;
  landing.executed.clear();
  landing.zeros = here_.state.sliding;
  landing.zeros.insert(landing.zeros.end(), here_.state.resting.begin(), here_.state.resting.end());
  const auto n = at(kernel_.event_functions());
  for (auto* values : {&landing.zero_values, &values_.value, &values_.magnitude, &values_.slope}) values->resize(n);
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), landing.zero_values.data());
  landing.rates.assign(n, {});
  landing.motions.assign(n, std::nullopt);
  landing.held_before = holding_.resting();
  landing.resting.clear();
  if (kernel_.switching_functions() > 0) landing.transition = {};
  return landing;
}

/// At an event: what was located is at zero, too.
Run::Landing& Run::landing_at(const Located& located) {
  Landing& landing = landing_here();
  if (jumps_.none()) return landing;
  for (const auto function : located.functions) {
    const auto& entry = search_.functions()[function];
    if (entry.kind == FunctionKind::surface || entry.kind == FunctionKind::user) landing.zeros.push_back(entry.index);
  }
  return landing;
}

/// How fast the guards of jumps move here, and which of them are at zero.
void Run::note_guards(Landing& landing) {
  auto& slope = free_slope_;
  kernel_.field(here_.t, here_.x.data(), here_.state.alpha.data(), slope.data());
  for (std::size_t k = 0; k < surroundings_.system.jumps.size(); ++k) {
    const int guards = static_cast<int>(surroundings_.system.jumps[k].guards.numel());
    for (int g = 0; g < guards; ++g) {
      const int function = kernel_.jump_guard(static_cast<int>(k), g);
      const Rate rate = rates_.along(function, slope);
      if (!std::isfinite(rate.terms)) continue;
      Rate& largest = landing.rates[at(function)];
      largest = {std::max(largest.value, std::abs(rate.value)), std::max(largest.terms, rate.terms)};
    }
  }
}

/// Zeros that a jump has moved away are none any more.
void Run::drop_zeros(Landing& landing) {
  if (landing.zeros.empty()) return;
  find_values();
  std::erase_if(landing.zeros, [&](int function) {
    const auto f = at(function);
    return !(std::abs(values_.value[f] - landing.zero_values[f]) <= 8.0 * rounding_unit * values_.magnitude[f]);
  });
}

/// Signs of all user functions at the point as it is. One that was located here and is still at zero keeps the sign
/// just behind this time; one that a jump has put there has none yet (0).
void Run::read_user_signs(const Landing& landing) {
  find_values();
  auto& signs = user_signs_ = search_.user_signs();
  auto& vanish = user_zeros_;
  vanish.assign(signs.size(), false);
  for (std::size_t user = 0; user < signs.size(); ++user) {
    const int function = kernel_.switching_functions() + static_cast<int>(user);
    const double value = values_.value[at(function)];
    const bool located = contains(landing.zeros, function);
    vanish[user] =
        located || holding_.holds(function) || std::abs(value) <= 8.0 * rounding_unit * values_.magnitude[at(function)];
    if (holding_.holds(function) || (vanish[user] && !located)) signs[user] = 0;
    if (!vanish[user]) signs[user] = value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
  }
  search_.set_user_signs(signs, vanish);
}

/// One execution: the state behind it, and what that triggers.
bool Run::execute_jump(Landing& landing) {
  if (landing.executed.size() >= most_rounds) {
    std::vector<int> jumps;
    for (const auto& executed : landing.executed.items().last(100)) {
      if (!contains(jumps, executed.jump)) jumps.push_back(executed.jump);
    }
    fail(Termination::iteration_limit,
         fmt::format("{} jumps at t = {:.17g} without an end: {} trigger each other; make their conditions false by "
                     "what they set, or give one of them a delay",
                     most_rounds, here_.t, jump_names(jumps)));
    return false;
  }
  note_guards(landing);
  ExecutedJump& executed = landing.executed.append();
  executed.x = here_.x;
  executed.jump = jumps_.execute(jump_point(), here_.x);
  if (contacts_.owns(executed.jump) && !move_contacts()) return false;
  executed.x_after = here_.x;
  if (!cells_.empty()) cell_change_ = std::max(cell_change_, cells_.locate(here_.t, here_.x.data(), here_.state.alpha));
  drop_zeros(landing);
  if (!here_.state.alpha.empty())
    here_.state.alpha = selections_at(surroundings_, here_.t, here_.x.data(), here_.state.alpha);
  read_user_signs(landing);
  jumps_.update(jump_point());
  return !jumps_have_problem();
}

/// The mode afresh, as at a start (rule 6).
bool Run::decide_behind_jumps(Landing& landing) {
  landing.motions.assign(landing.motions.size(), std::nullopt);
  if (kernel_.switching_functions() == 0) {  // nothing to decide
    landing.transition.beside = here_.x;
    return enter(landing.transition);
  }
  std::vector<int> surfaces;
  for (const int function : landing.zeros) {
    if (function < kernel_.switching_functions()) surfaces.push_back(function);
  }
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  landing.transition =
      decide_behind_jump(surroundings_, here_.state, here_.t, here_.x.data(), here_.time_scale, surfaces, resting);
  if (landing.transition.termination != Termination::completed) {
    fail(landing.transition.termination, landing.transition.message);
    return false;
  }
  choices_.choose(landing.transition, progress());
  return enter(landing.transition);
}

/// Of the terms of an event function here.
double Run::size_at(int function) {
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), values_.magnitude.data(), values_.slope.data());
  return values_.magnitude[at(function)];
}

/// Where a function at zero goes along the motion of the mode. Asked again before the mode is decided anew, it is
/// known.
Motion Run::motion_of(int function, Landing& landing) {
  auto& known = landing.motions[at(function)];
  if (!known) known = find_motion(function, landing);
  return *known;
}

Occasion Run::at_this_time() const {
  Occasion occasion;
  occasion.t = here_.t;
  occasion.x = here_.x.data();
  occasion.time_scale = here_.time_scale;
  return occasion;
}

Motion Run::find_motion(int function, const Landing& landing) {
  // The derivatives along fixed selections are not those of a motion that slides.
  if (!surfaces_keeping(function).empty()) return {};
  // What is left where terms cancel (two bodies that move together, jumps one after the other) is their rounding: less
  // than sign_tolerance / 1000 of them.
  constexpr double cancelled = 1e-3;
  const Rate rate = rates_.here(function);
  const Rate& here = landing.rates[at(function)];
  const double scale = std::max({here.value, std::abs(rate.value), cancelled * here.terms, cancelled * rate.terms});
  // A rate that the second derivative turns around within the rounding of the function is none: it may as well be that
  // of a state at rest.
  const double bend = kernel_.lie_derivative(function, 2, here_.t, here_.x.data(), here_.state.alpha.data());
  if (rate.value * bend < 0.0 && rate.value * rate.value <= 2.0 * std::abs(bend) * rounding_unit * size_at(function)) {
    return {{0.0, bend > 0.0 ? switching::Drift::up : switching::Drift::down}, 2};
  }
  if (const auto motion = ProjectedFields::motion_by_velocity(rate.value, scale)) return *motion;
  const Occasion occasion = at_this_time();
  const ProjectedFields fields(kernel_, occasion);
  return fields.motion(here_.state.alpha, function, rate.value, scale);
}

/// Signs of functions that are at zero behind jumps: those they get along the motion.
void Run::give_directions(Landing& landing) {
  auto& values = values_.value;
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values.data());
  auto& signs = user_signs_ = search_.user_signs();
  auto& vanish = user_zeros_ = search_.user_zeros();
  std::vector<int> orders(signs.size(), 1);
  for (std::size_t user = 0; user < signs.size(); ++user) {
    const int function = kernel_.switching_functions() + static_cast<int>(user);
    if (!vanish[user] || holding_.holds(function) || jumps_.is_discrete_guard(function)) continue;
    const Motion motion = motion_of(function, landing);
    signs[user] = static_cast<int>(motion.side.drift);
    if (contacts_.guards(function)) {
      // Its mode holds from here on, whatever the roundings of its derivatives say.
      orders[user] = signs[user] < 0 ? std::clamp(motion.order, 1, 2) : 2;
      signs[user] = -1;
      if (!contains(landing.zeros, function)) landing.zeros.push_back(function);
      landing.zero_values[at(function)] = values[at(function)];
      continue;
    }
    // What is left of a rate that was held at 0, and of its derivative where holding ends, is rounding.
    const int ahead = motion.order > 1 ? side_ahead(surroundings_, here_.state, at_this_time(), here_.x, function) : 0;
    if (ahead != 0) signs[user] = ahead;
    orders[user] = std::clamp(motion.order, 1, 2);  // as many as the search divides out
    // A jump that leaves it here leaves it this sign.
    if (!contains(landing.zeros, function)) landing.zeros.push_back(function);
    landing.zero_values[at(function)] = values[at(function)];
  }
  search_.set_user_signs(signs, vanish, orders);
  search_.enter(here_.state, landing.transition.zero_order, here_.t, here_.x.data());
}

/// Executes everything that is due at here_.t, with all that follows at once; the mode behind is in force then.
bool Run::settle_jumps(Landing& landing) {
  do {
    while (running_ && jumps_.due(here_.t)) {
      if (!execute_jump(landing)) return false;
    }
    if (!decide_behind_jumps(landing)) return false;
    if (hold_resting(landing) && !decide_behind_jumps(landing)) return false;
    if (!running_) return false;
    give_directions(landing);
    jumps_.update(jump_point());
    if (jumps_have_problem()) return false;
  } while (jumps_.due(here_.t));
  if (!landing.executed.empty()) landing.executed.back().x_after = here_.x;
  return true;
}

/// Rules 4 to 6 at an event: user events of the motion before, the jumps, user events by them.
bool Run::jump(const ModeState& before, const std::vector<double>& x_before, Landing& landing) {
  jumped_ = true;
  const auto fired = fire_user_events(here_.x, before);
  const Termination stopped = result_.status.termination;
  const std::string message = result_.status.message;
  running_ = true;  // an event that stops the run lets the jumps of its time happen
  note_guards(landing);
  if (!landing.held_before.empty()) {
    holding_.release_all();
    search_.set_held({}, {});
  }
  const bool settled = settle_jumps(landing);
  if (!landing.executed.empty()) {
    landing.transition.state = here_.state;
    recorder_.jumped(here_.t, landing.executed.items(), &before, landing.transition);
  }
  if (!settled) return false;
  if (!landing.resting.empty()) {
    recorder_.accumulated(here_.t, landing.resting, {here_.x, here_.x, here_.state, here_.state}, resting_reason);
  }
  if (stopped != Termination::completed) fail(stopped, message);
  fire_user_events(x_before, before, fired);
  note_series(landing);
  start_step();
  static_cast<void>(steps_.memory().change(here_.state.mode, here_.t,
                                           here_.h));  // the mode lasts from here; its step is that of a start
  return running_;
}

/// A time at which jumps are due, reached by a step that ended exactly there.
Run::Step Run::jump_in_time() {
  const Arrival arrival =
      arrive(recorder_.ends_at(here_.t) ? OutputRows::Arrival::written : OutputRows::Arrival::missing);
  Landing& landing = landing_here();
  jumps_.update(jump_point());
  if (jumps_have_problem()) return depart(arrival);
  if (!jumps_.due(here_.t)) return Step::taken;
  static_cast<void>(jump(before_, x_before_, landing));
  return depart(arrival);
}

/// Rule 3, before the first mode is decided.
bool Run::begin_jumps(Landing& landing) {
  if (jumps_.none()) return true;
  here_.state.mode.assign(at(kernel_.switching_functions()), 0);
  here_.state.alpha.assign(here_.state.mode.size(), 0.5);
  here_.state.alpha = selections_at(surroundings_, here_.t, here_.x.data(), here_.state.alpha);
  if (!begin_contacts(landing)) return false;
  read_user_signs(landing);
  jumps_.begin(jump_point());
  if (jumps_have_problem()) return false;
  while (jumps_.due(here_.t)) {
    if (!execute_jump(landing)) return false;
  }
  return true;
}

/// Guards at zero at the start, and what they trigger by moving on.
bool Run::settle_at_start(Landing& landing) {
  if (jumps_.none()) return true;
  if (hold_resting(landing) && !decide_behind_jumps(landing)) return false;
  if (!running_) return false;
  give_directions(landing);
  jumps_.update(jump_point());
  if (jumps_have_problem()) return false;
  if (jumps_.due(here_.t) && !settle_jumps(landing)) return false;
  landing.transition.state = here_.state;
  if (!landing.executed.empty()) landing.executed.back().x_after = here_.x;
  note_series(landing);
  return true;
}

/// A step as at a start: from the field of the continuous states alone, not beyond the last lap of a shrinking sequence
/// of jumps.
void Run::start_step() {
  here_.h = steps_.initial_step();
  if (const auto lap = jump_series_.last_lap()) here_.h = std::min(here_.h, *lap);
  field_(here_.t, here_.x.data(), free_slope_.data());  // selections back to those of this point
}

}  // namespace saltus::event_integrator
