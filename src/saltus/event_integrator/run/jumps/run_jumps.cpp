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
  kernel_.functions(t_, x_.data(), state_.alpha.data(), values_.value.data());
  kernel_.scales(t_, x_.data(), state_.alpha.data(), values_.magnitude.data(), values_.slope.data());
}

/// At a point where only the surfaces of the sliding mode are at zero. Valid until the next one is made.
Run::Landing& Run::landing_here() {
  Landing& landing = landing_;
  if (jumps_.none()) return landing;
  landing.executed.clear();
  landing.zeros = state_.sliding;
  landing.zeros.insert(landing.zeros.end(), state_.resting.begin(), state_.resting.end());
  const auto n = at(kernel_.event_functions());
  for (auto* values : {&landing.zero_values, &values_.value, &values_.magnitude, &values_.slope}) values->resize(n);
  kernel_.functions(t_, x_.data(), state_.alpha.data(), landing.zero_values.data());
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

Run::Rate Run::rate_along_field(int function, double t, const double* x, const double* slope) {
  auto& row = gradient_;
  row.resize(x_.size());
  Rate rate;
  kernel_.gradient(function, t, x, state_.alpha.data(), row.data(), &rate.value);
  rate.terms = std::abs(rate.value);
  rate.magnitude = rate.value == 0.0 ? 0.0 : std::abs(rate.value * t);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const double term = row[i] == 0.0 ? 0.0 : row[i] * slope[i];
    rate.value += term;
    rate.magnitude += row[i] == 0.0 ? 0.0 : std::abs(row[i] * x[i]);
    rate.terms += std::abs(term);
    rate.slope += std::abs(row[i]);
  }
  return rate;
}

/// How fast the guards of jumps move here, and which of them are at zero.
void Run::note_guards(Landing& landing) {
  auto& slope = row_slope_;
  kernel_.field(t_, x_.data(), state_.alpha.data(), slope.data());
  for (std::size_t k = 0; k < surroundings_.system.jumps.size(); ++k) {
    const int guards = static_cast<int>(surroundings_.system.jumps[k].guards.numel());
    for (int g = 0; g < guards; ++g) {
      const int function = kernel_.jump_guard(static_cast<int>(k), g);
      const Rate rate = rate_along_field(function, t_, x_.data(), slope.data());
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
                     most_rounds, t_, jump_names(jumps)));
    return false;
  }
  note_guards(landing);
  ExecutedJump& executed = landing.executed.append();
  executed.x = x_;
  executed.jump = jumps_.execute(jump_point(), x_);
  if (contacts_.owns(executed.jump) && !move_contacts()) return false;
  executed.x_after = x_;
  if (!cells_.empty()) cell_change_ = std::max(cell_change_, cells_.locate(t_, x_.data(), state_.alpha));
  drop_zeros(landing);
  if (!state_.alpha.empty()) state_.alpha = selections_at(surroundings_, t_, x_.data(), state_.alpha);
  read_user_signs(landing);
  jumps_.update(jump_point());
  return !jumps_have_problem();
}

/// The mode afresh, as at a start (rule 6).
bool Run::decide_behind_jumps(Landing& landing) {
  landing.motions.assign(landing.motions.size(), std::nullopt);
  if (kernel_.switching_functions() == 0) {  // nothing to decide
    landing.transition.beside = x_;
    return enter(landing.transition);
  }
  std::vector<int> surfaces;
  for (const int function : landing.zeros) {
    if (function < kernel_.switching_functions()) surfaces.push_back(function);
  }
  RestingSurfaces resting;
  if (!find_resting(resting)) return false;
  landing.transition = decide_behind_jump(surroundings_, state_, t_, x_.data(), h_scale_, surfaces, resting);
  if (landing.transition.termination != Termination::completed) {
    fail(landing.transition.termination, landing.transition.message);
    return false;
  }
  choose(landing.transition);
  return enter(landing.transition);
}

/// Of the terms of an event function here.
double Run::size_at(int function) {
  kernel_.scales(t_, x_.data(), state_.alpha.data(), values_.magnitude.data(), values_.slope.data());
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
  occasion.t = t_;
  occasion.x = x_.data();
  occasion.time_scale = h_scale_;
  return occasion;
}

Motion Run::find_motion(int function, const Landing& landing) {
  // The derivatives along fixed selections are not those of a motion that slides.
  if (!surfaces_keeping(function).empty()) return {};
  // What is left where terms cancel (two bodies that move together, jumps one after the other) is their rounding: less
  // than sign_tolerance / 1000 of them.
  constexpr double cancelled = 1e-3;
  const Rate rate = rate_along_field(function, t_, x_.data(), slope_.data());
  const Rate& here = landing.rates[at(function)];
  const double scale = std::max({here.value, std::abs(rate.value), cancelled * here.terms, cancelled * rate.terms});
  // A rate that the second derivative turns around within the rounding of the function is none: it may as well be that
  // of a state at rest.
  const double bend = kernel_.lie_derivative(function, 2, t_, x_.data(), state_.alpha.data());
  if (rate.value * bend < 0.0 && rate.value * rate.value <= 2.0 * std::abs(bend) * rounding_unit * size_at(function)) {
    return {{0.0, bend > 0.0 ? switching::Drift::up : switching::Drift::down}, 2};
  }
  if (const auto motion = ProjectedFields::motion_by_velocity(rate.value, scale)) return *motion;
  const Occasion occasion = at_this_time();
  const ProjectedFields fields(kernel_, occasion);
  return fields.motion(state_.alpha, function, rate.value, scale);
}

/// Signs of functions that are at zero behind jumps: those they get along the motion.
void Run::give_directions(Landing& landing) {
  auto& values = values_.value;
  kernel_.functions(t_, x_.data(), state_.alpha.data(), values.data());
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
    const int ahead = motion.order > 1 ? side_ahead(surroundings_, state_, at_this_time(), x_, function) : 0;
    if (ahead != 0) signs[user] = ahead;
    orders[user] = std::clamp(motion.order, 1, 2);  // as many as the search divides out
    // A jump that leaves it here leaves it this sign.
    if (!contains(landing.zeros, function)) landing.zeros.push_back(function);
    landing.zero_values[at(function)] = values[at(function)];
  }
  search_.set_user_signs(signs, vanish, orders);
  search_.enter(state_, landing.transition.zero_order, t_, x_.data());
}

/// Executes everything that is due at t_, with all that follows at once; the mode behind is in force then.
bool Run::settle_jumps(Landing& landing) {
  do {
    while (running_ && jumps_.due(t_)) {
      if (!execute_jump(landing)) return false;
    }
    if (!decide_behind_jumps(landing)) return false;
    if (hold_resting(landing) && !decide_behind_jumps(landing)) return false;
    if (!running_) return false;
    give_directions(landing);
    jumps_.update(jump_point());
    if (jumps_have_problem()) return false;
  } while (jumps_.due(t_));
  if (!landing.executed.empty()) landing.executed.back().x_after = x_;
  return true;
}

/// Rules 4 to 6 at an event: user events of the motion before, the jumps, user events by them.
bool Run::jump(const ModeState& before, const std::vector<double>& x_before, Landing& landing) {
  jumped_ = true;
  const auto fired = fire_user_events(x_, before);
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
    landing.transition.state = state_;
    recorder_.jumped(t_, landing.executed.items(), &before, landing.transition);
  }
  if (!settled) return false;
  if (!landing.resting.empty()) {
    recorder_.accumulated(t_, landing.resting, {x_, x_, state_, state_}, resting_reason);
  }
  if (stopped != Termination::completed) fail(stopped, message);
  fire_user_events(x_before, before, fired);
  note_series(landing);
  start_step();
  static_cast<void>(step_memory_.change(state_.mode, t_, h_));  // the mode lasts from here; its step is that of a start
  return running_;
}

/// A time at which jumps are due, reached by a step that ended exactly there.
Run::Step Run::jump_in_time() {
  const Arrival arrival = arrive(recorder_.ends_at(t_) ? RowBefore::written : RowBefore::missing);
  Landing& landing = landing_here();
  jumps_.update(jump_point());
  if (jumps_have_problem()) return depart(arrival);
  if (!jumps_.due(t_)) return Step::taken;
  static_cast<void>(jump(before_, x_before_, landing));
  return depart(arrival);
}

/// Rule 3, before the first mode is decided.
bool Run::begin_jumps(Landing& landing) {
  if (jumps_.none()) return true;
  state_.mode.assign(at(kernel_.switching_functions()), 0);
  state_.alpha.assign(state_.mode.size(), 0.5);
  state_.alpha = selections_at(surroundings_, t_, x_.data(), state_.alpha);
  if (!begin_contacts(landing)) return false;
  read_user_signs(landing);
  jumps_.begin(jump_point());
  if (jumps_have_problem()) return false;
  while (jumps_.due(t_)) {
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
  if (jumps_.due(t_) && !settle_jumps(landing)) return false;
  landing.transition.state = state_;
  if (!landing.executed.empty()) landing.executed.back().x_after = x_;
  note_series(landing);
  return true;
}

/// A step as at a start: from the field of the continuous states alone, not beyond the last lap of a shrinking sequence
/// of jumps.
void Run::start_step() {
  const auto step_from = [&](ode::RightHandSide f, const double* x, const double* slope) {
    return ode::initial_step(options_.method, f, t_, x, slope, static_cast<int>(continuous_.size()), span(),
                             tolerances_);
  };
  if (continuous_.size() == x_.size()) {
    h_ = step_from(right_hand_side(), x_.data(), slope_.data());
  } else {
    const auto select = [&](const std::vector<double>& all) {
      std::vector<double> selected;
      for (const auto i : continuous_) selected.push_back(all[i]);
      return selected;
    };
    std::vector<double> point = x_;
    std::vector<double> rate(x_.size());
    const auto right_hand_side_of_continuous = [&](double t, const double* x, double* xdot) {
      for (std::size_t k = 0; k < continuous_.size(); ++k) point[continuous_[k]] = x[k];
      field_(t, point.data(), rate.data());
      for (std::size_t k = 0; k < continuous_.size(); ++k) xdot[k] = rate[continuous_[k]];
    };
    h_ = step_from(right_hand_side_of_continuous, select(x_).data(), select(slope_).data());
  }
  if (const auto lap = jump_series_.last_lap()) h_ = std::min(h_, *lap);
  field_(t_, x_.data(), row_slope_.data());  // selections back to those of this point
  control_.reset();
}

}  // namespace saltus::event_integrator
