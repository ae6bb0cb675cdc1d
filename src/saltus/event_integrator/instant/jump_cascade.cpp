#include "saltus/event_integrator/instant/jump_cascade.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "saltus/event_integrator/decide/sets/find_resting_surfaces.hpp"
#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// How far the gap of a contact may be from 0 that was closed before one of these jumps, and is open now; 0 for other
/// functions.
double left_by_opening(const Contacts& contacts, int function, std::span<const ExecutedJump> executed) {
  const bool was_closed = std::any_of(executed.begin(), executed.end(), [&](const auto& one) {
    return contacts.tolerated(function, one.activities) == 0.0;
  });
  return was_closed ? contacts.tolerated(function) : 0.0;
}

}  // namespace

/// All functions of the kernel here.
void JumpCascade::find_values() {
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values_.value.data());
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), values_.magnitude.data(), values_.slope.data());
}

void JumpCascade::begin() {
  if (jumps_.none()) return;
  executed_.clear();
  left_.clear();
  ledger_.begin(here_.t);
  ledger_.forget_surfaces();
  for (const auto* held : {&here_.state.sliding, &here_.state.resting}) {
    for (const int j : *held) ledger_.add(j);
  }
  const auto n = at(kernel_.event_functions());
  for (auto* values : {&zero_values_, &values_.value, &values_.magnitude, &values_.slope}) values->resize(n);
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), zero_values_.data());
  largest_rates_.assign(n, {});
  motions_.resize(n);
  forget_motions();
  held_before_ = holding_.held().all();
  resting_.clear();
  if (kernel_.switching_functions() > 0) transition_ = {};
}

ExecutedJump& JumpCascade::begin_execution(int jump, const std::vector<double>& x, const Activities& activities) {
  ExecutedJump& executed = executed_.append();
  executed.jump = jump;
  executed.x = x;
  executed.activities = activities;
  executed.impulses.resize(0);
  executed.why_open.clear();
  return executed;
}

void JumpCascade::end_execution() {
  if (executed_.empty()) return;
  executed_.back().x_after = here_.x;
  executed_.back().activities_after = contacts_.activities();
}

void JumpCascade::end_execution_of_contacts() {
  end_execution();
  executed_.back().impulses = contacts_.impulses();
  executed_.back().why_open = contacts_.why_open();
}

void JumpCascade::begin(const Located& located) {
  begin();
  if (jumps_.none()) return;
  for (const auto function : located.functions) {
    const auto& entry = search_.functions()[function];
    if (entry.kind == FunctionKind::surface) ledger_.add(entry.index);
  }
}

void JumpCascade::note_guards() {
  auto& slope = slope_;
  kernel_.field(here_.t, here_.x.data(), here_.state.alpha.data(), slope.data());
  for (std::size_t k = 0; k < switching_context_.layout.jumps.size(); ++k) {
    if (contacts_.owns(static_cast<int>(k))) continue;  // velocities that an impact ends are 0 exactly
    const int guards = static_cast<int>(switching_context_.layout.jumps[k].guards.size());
    for (int g = 0; g < guards; ++g) {
      const int function = kernel_.jump_guard(static_cast<int>(k), g);
      const Rate rate = rates_.along(function, slope);
      if (!std::isfinite(rate.terms)) continue;
      Rate& largest = largest_rates_[at(function)];
      largest = {std::max(largest.value, std::abs(rate.value)), std::max(largest.terms, rate.terms)};
    }
  }
}

/// How far the time here may be from that of the event, to its rounding and by what is left of what was located. The
/// iteration of implicit steps leaves more than rounding.
double JumpCascade::time_resolution() const {
  const double rounding = rounding_unit * std::abs(here_.t);
  double left = 0.0;
  for (const int zero : ledger_.zeros()) {
    const double rate = largest_rates_[at(zero)].value;
    if (rate > 0.0) left = std::max(left, std::abs(zero_values_[at(zero)]) / rate);
  }
  constexpr double least = 8.0, most = 1e4;
  return std::clamp(2.0 * left, least * rounding, most * rounding);
}

/// Rounding of a function here, and what that of the time leaves of it where it was located.
double JumpCascade::resolution(int function) const {
  const auto f = at(function);
  return rounding_of(values_.magnitude[f]) + time_resolution() * largest_rates_[f].value;
}

/// Whether jumps have left the value of a function as it was.
bool JumpCascade::is_unchanged(int function) const {
  return std::abs(values_.value[at(function)] - zero_values_[at(function)]) <= resolution(function);
}

/// Whether jumps have left a function at zero, or no farther from it.
bool JumpCascade::stays_at_zero(int function) const {
  const bool closer = std::abs(values_.value[at(function)]) <= std::abs(zero_values_[at(function)]);
  return is_unchanged(function) || (closer && !contacts_.guards(function));
}

void JumpCascade::drop_zeros() {
  if (ledger_.zeros().empty()) return;
  find_values();
  ledger_.drop([&](int function) { return !stays_at_zero(function); });
}

void JumpCascade::read_user_signs(Gaps gaps) {
  find_values();
  for (std::size_t user = 0; user < ledger_.signs().size(); ++user) {
    const int function = user_of(user);
    const double value = values_.value[at(function)];
    const bool unchanged = is_unchanged(function);
    const double of_gap =
        gaps == Gaps::begun ? contacts_.tolerated(function) : left_by_opening(contacts_, function, executed_.items());
    const double rounding =
        std::max(unchanged ? rounding_of(values_.magnitude[at(function)]) : resolution(function), of_gap);
    const bool held = holding_.holds(function);
    if (held || ledger_.has(function) || std::abs(value) <= rounding) {
      const bool keeps_sign = ledger_.has(function) && !held;
      ledger_.put(function, keeps_sign ? ledger_.sign(function) : 0);
      continue;
    }
    const bool turns = ledger_.sign(function) * value < 0.0;
    const bool keeps_sign = turns && unchanged && search_.is_within_errors(function, value, here_.t, here_.x.data());
    if (!keeps_sign) ledger_.set_sign(function, value > 0.0 ? 1 : value < 0.0 ? -1 : 0);
  }
}

/// Of the terms of an event function here.
double JumpCascade::size_at(int function) {
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), values_.magnitude.data(), values_.slope.data());
  return values_.magnitude[at(function)];
}

/// Where a function at zero goes along the motion of the mode. Asked again before the mode is decided anew, it is
/// known.
Motion JumpCascade::motion_of(int function) {
  auto& known = motions_[at(function)];
  if (!known) known = find_motion(function);
  return *known;
}

SwitchingPoint JumpCascade::at_this_time() const {
  SwitchingPoint switching_point;
  switching_point.begin(here_.t, here_.x.data(), here_.time_scale);
  return switching_point;
}

Motion JumpCascade::find_motion(int function) {
  // The derivatives along fixed selections are not those of a motion that slides.
  const bool kept = is_kept_by_sliding(kernel_, here_.state, function, here_.t, here_.x.data());
  if (kept || !surfaces_keeping(function).empty()) return {};
  // What is left where terms cancel (two bodies that move together, jumps one after the other) is their rounding: less
  // than sign_tolerance / 1000 of them.
  constexpr double cancelled = 1e-3;
  const auto gap = contacts_.gap_motion(function, {here_.t, here_.state.alpha, here_.time_scale},
                                        contacts_.activities(), here_.x, here_.slope, along_);
  const Rate rate = gap ? Rate{gap->rate, gap->terms} : rates_.here(function);
  const Rate& here = largest_rates_[at(function)];
  // What kept its rate at 0 has just let go: errors are left of it, unless a jump changes it.
  const auto left = std::find_if(left_.begin(), left_.end(), [&](const auto& l) { return l.function == function; });
  if (left != left_.end() && std::abs(rate.value) <= 2.0 * here.value) {
    return {{0.0, left->side > 0 ? switching::Drift::up : switching::Drift::down}, 2};
  }
  const double scale = std::max({here.value, std::abs(rate.value), cancelled * here.terms, cancelled * rate.terms});
  const auto by_rate = ProjectedFields::motion_by_velocity(rate.value, scale);
  // The mode of a contact has been decided with the next derivatives, and holds.
  if (!by_rate && contacts_.guards(function)) return {{}, 2};
  // A rate that the second derivative turns around within the rounding of the function is none: it may as well be that
  // of a state at rest.
  const double bend =
      gap ? gap->bend : kernel_.lie_derivative(function, 2, here_.t, here_.x.data(), here_.state.alpha.data());
  const auto size = [&] { return gap ? gap->size : size_at(function); };
  if (rate.value * bend < 0.0 && rate.value * rate.value <= 2.0 * std::abs(bend) * rounding_unit * size()) {
    return {{0.0, bend > 0.0 ? switching::Drift::up : switching::Drift::down}, 2};
  }
  if (by_rate) return *by_rate;
  const SwitchingPoint switching_point = at_this_time();
  const ProjectedFields fields(kernel_, switching_point);
  return fields.motion(here_.state.alpha, function, rate.value, scale);
}

void JumpCascade::give_directions() {
  auto& values = values_.value;
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values.data());
  for (const int function : std::vector<int>(ledger_.zeros())) {
    if (function < user_of(0) || holding_.holds(function) || jumps_.is_discrete_guard(function)) continue;
    const Motion motion = motion_of(function);
    const int side = static_cast<int>(motion.side.drift);
    // A jump that leaves it here leaves it this sign.
    zero_values_[at(function)] = values[at(function)];
    if (contacts_.guards(function)) {
      // Its mode holds from here on, whatever the roundings of its derivatives say. A gap opens as its force comes to
      // 0, with an acceleration of 0: it goes like t^3, and its first derivatives are what the steps leave of them.
      const bool opens = left_by_opening(contacts_, function, executed_.items()) > 0.0;
      ledger_.put(function, -1, opens ? 3 : side < 0 ? std::clamp(motion.order, 1, 2) : 2);
      continue;
    }
    // What is left of a rate that was held at 0, and of its derivative where holding ends, is rounding.
    const int ahead =
        motion.order > 1 ? side_ahead(switching_context_, here_.state, at_this_time(), here_.x, function) : 0;
    ledger_.put(function, ahead != 0 ? ahead : side, std::clamp(motion.order, 1, 2));  // as many as are divided out
  }
  search_.enter(here_.state, transition_.zero_order, here_.t, here_.x.data());
}

/// The surfaces that keep a guard at zero at rest by sliding: with other selections of theirs it would leave. None if
/// the guard is not kept so.
std::vector<int> JumpCascade::surfaces_keeping(int function) {
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
  return std::abs(bend(field_.alpha())) <= no_effect * range ? surfaces : std::vector<int>{};
}

std::vector<HeldGuard> JumpCascade::guards_kept_by_sliding(const RestingGuards& others) {
  std::vector<HeldGuard> kept;
  std::vector<int> surfaces;
  if (here_.state.sliding.empty() || !holding_.guards().empty()) return kept;
  for (int jump = 0; jump < static_cast<int>(switching_context_.layout.jumps.size()); ++jump) {
    if (contacts_.owns(jump)) continue;
    for (int g = 0; g < static_cast<int>(switching_context_.layout.jumps[at(jump)].guards.size()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      if (!ledger_.has(function) || jumps_.is_discrete_guard(function)) continue;
      const Motion motion = motion_of(function);
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
      held ? find_resting_surfaces(switching_context_, holding_, here_.t, here_.state.alpha, x) : RestingSurfaces{};
  holding_.release_all();
  const bool kept_by_guards =
      std::all_of(surfaces.begin(), surfaces.end(), [&](int j) { return contains(resting.surfaces, j); });
  if (!resting.problem.empty() || !kept_by_guards) kept.clear();
  return kept;
}

JumpCascade::RestingGuards JumpCascade::pressed_guards() {
  RestingGuards guards;
  std::vector<int> jumps;
  for (const auto& executed : executed_.items()) {
    if (!contains(jumps, executed.jump)) jumps.push_back(executed.jump);
  }
  for (const auto& guard : held_before_) {
    if (!contains(jumps, guard.hold.jump)) jumps.push_back(guard.hold.jump);
  }
  for (const int jump : jumps) {
    if (contacts_.owns(jump)) continue;
    for (int g = 0; g < static_cast<int>(switching_context_.layout.jumps[at(jump)].guards.size()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      if (!ledger_.has(function) || jumps_.is_discrete_guard(function)) continue;
      // The derivatives along fixed selections are not those of a motion that slides.
      if (!surfaces_keeping(function).empty()) continue;
      const Motion motion = motion_of(function);
      const int drift = static_cast<int>(motion.side.drift);
      const int inward = jumps_.trigger_sign(jump, g, jump_point(), drift);
      if (motion.order < 2 || inward == 0 || drift != inward) continue;
      const HeldGuard guard{{jump, function}, inward};
      (holding_.can_rest(guard, here_.t, here_.state.alpha, here_.x) ? guards.held : guards.loose).push_back(guard);
    }
  }
  return guards;
}

/// Whether a guard is the gap of an open contact, 0 to its rounding. It is open until its own jump, whatever that
/// rounding says.
bool JumpCascade::is_open_at_zero(int function) {
  const double rounding = contacts_.tolerated(function);
  if (rounding == 0.0) return false;
  find_values();
  return std::abs(values_.value[at(function)]) <= rounding;
}

void JumpCascade::leave_guards(const std::vector<int>& zero_order) {
  bool any = false;
  for (int jump = 0; jump < static_cast<int>(switching_context_.layout.jumps.size()); ++jump) {
    for (int g = 0; g < static_cast<int>(switching_context_.layout.jumps[at(jump)].guards.size()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      const bool by_contact = contacts_.owns(jump);
      const int sign = ledger_.sign(function);
      const bool leaves = by_contact ? sign >= 0 && is_open_at_zero(function) : sign == 0;
      if (!leaves || holding_.holds(function) || jumps_.is_discrete_guard(function)) continue;
      const int side = by_contact ? -1 : side_ahead(switching_context_, here_.state, at_this_time(), here_.x, function);
      if (side == 0) continue;
      if (!by_contact) left_.push_back({function, side});
      ledger_.put(function, side, 2);  // at least: its rate was held at 0
      any = true;
    }
  }
  if (any) search_.enter(here_.state, zero_order, here_.t, here_.x.data());
}

}  // namespace saltus::event_integrator
