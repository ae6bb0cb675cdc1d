// Accumulation of jumps: its limit, and what holds behind it.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

/// Held guards on which nothing presses any more are free; returns whether there were any.
bool Run::release(const Located& located) {
  event_.freed.clear();
  if (holding_.guards().empty()) return false;
  std::vector<HeldGuard> guards = holding_.guards();
  auto signs = search_.user_signs();
  std::vector<bool> vanish(signs.size(), false);
  std::vector<int> orders(signs.size(), 1);
  for (const auto function : located.functions) {
    const auto& entry = search_.functions()[function];
    if (entry.kind == FunctionKind::user) vanish[at(entry.index - kernel_.switching_functions())] = true;
    if (entry.kind != FunctionKind::release) continue;
    std::erase_if(guards, [&](const HeldGuard& guard) { return guard.hold.function == entry.index; });
  }
  if (guards.size() == holding_.guards().size()) return false;
  const auto before = holding_.held().all();
  const auto problem = holding_.hold(std::move(guards), holding_.held().followers, here_.t, here_.state.alpha, here_.x);
  if (problem) fail(Termination::outside_class, fmt::format("at t = {:.17g} {}", here_.t, *problem));
  for (const auto& guard : before) {
    if (holding_.holds(guard.hold.function)) continue;
    // It moves outward from here, whatever the roundings of its derivatives say.
    const auto user = at(guard.hold.function - kernel_.switching_functions());
    signs[user] = -guard.inward;
    vanish[user] = true;
    orders[user] = 2;  // at least: nothing presses on it
  }
  search_.set_held(holding_.held());
  search_.set_user_signs(signs, vanish, orders);
  RestingSurfaces resting;
  if (!here_.state.resting.empty() && find_resting(resting)) {
    std::set_difference(here_.state.resting.begin(), here_.state.resting.end(), resting.surfaces.begin(),
                        resting.surfaces.end(), std::back_inserter(event_.freed));
  }
  return true;
}

/// Whether jumps change nothing at their limit, and their conditions come true there by what they do not set: the
/// conditions then hold behind it, and nothing fires again. Their guards are at zero in the cascade.
bool Run::change_nothing(const std::vector<int>& jumps) {
  FieldRates rates(kernel_, here_);
  std::vector<double> slope(here_.x.size());
  kernel_.field(here_.t, here_.x.data(), here_.state.alpha.data(), slope.data());
  std::vector<bool> vanish = search_.user_zeros();
  for (const int jump : jumps) {
    const auto& targets = switching_context_.layout.jumps[at(jump)].targets;
    std::vector<double> values(targets.size());
    kernel_.jump_values(jump, here_.t, here_.x.data(), here_.state.alpha.data(), values.data());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double x = here_.x[at(targets[i])];
      if (!(std::abs(values[i] - x) <= tolerances_.step().atol + tolerances_.step().rtol * std::abs(x))) return false;
      slope[at(targets[i])] = 0.0;
    }
    bool comes_true = false;
    for (int g = 0; g < static_cast<int>(switching_context_.layout.jumps[at(jump)].guards.size()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      const Rate rate = rates.along(function, slope);
      const double resolved = tolerances_.step().atol * rate.slope + tolerances_.step().rtol * rate.magnitude;
      if (jumps_.is_discrete_guard(function) || !(std::abs(cascade_.zero_value(function)) <= resolved)) continue;
      comes_true = jumps_.trigger_sign(jump, g, jump_point(), 0) * rate.value > 0.0;
      if (!comes_true) return false;
      cascade_.add_zero(function);
      vanish[at(function - kernel_.switching_functions())] = true;
    }
    if (!comes_true) return false;
  }
  search_.set_user_signs(search_.user_signs(), vanish);
  return true;
}

/// If the jumps up to here have a limit that nothing else precedes, the run goes on from there.
void Run::accumulate_jumps() {
  if (jumps_.none()) return;
  const auto limit = jump_accumulation_.limit();
  if (limit && limit->t <= std::min(options_.until, jumps_.next_time())) return follow_limit(*limit);
  if (event_.last_bounces.empty()) return;
  jump_accumulation_.clear();
  drop_repeats(event_.last_bounces);
  recorder_.accumulated(here_.t, event_.last_bounces, {here_.x, here_.x, here_.state, here_.state},
                        "no more is left of these impacts than rounding");
}

void Run::follow_limit(const SeriesLimit& limit) {
  field_(here_.t, here_.x.data(), here_.slope.data());
  if (!here_.state.sliding.empty()) here_.state.alpha = field_.alpha();
  const ModeState before = here_.state;
  const std::vector<double> x_last = here_.x;
  if (std::any_of(limit.events.begin(), limit.events.end(), [&](int jump) { return contacts_.owns(jump); })) {
    return settle_contacts(limit, x_last, before);
  }
  std::vector<HeldGuard> guards = holding_.held().all();
  std::vector<int> jumps;
  double rate = 0.0;
  for (const int jump : limit.events) {
    const auto guard = jump_accumulation_.last_guard(jump);
    if (!guard) continue;
    guards.push_back(*guard);
    jumps.push_back(jump);
    rate = std::max(rate, jump_accumulation_.last_rate(jump));
  }
  jump_accumulation_.end(limit);
  pass_to(limit.t, limit.x);
  cascade_.begin();
  const auto accumulated = [&] {
    recorder_.accumulated(here_.t, limit.events, {x_last, here_.x, before, here_.state},
                          limit.kind == SeriesKind::chattering
                              ? "these jumps follow each other faster than their guards are resolved"
                              : "the intervals of these jumps shrink geometrically: the state is their limit");
    row(here_.t, here_.x);
    event_.last_time = here_.t;
  };
  const bool ends = jumps.empty() && change_nothing(limit.events);
  if (jumps.empty() && !ends) {
    fail(Termination::outside_class,
         fmt::format("the jumps {} accumulate at t = {:.17g}, but no guard of theirs is left at 0: what follows is not "
                     "determined",
                     jump_names(limit.events), here_.t));
  }
  if (outcome_.running && !ends && hold(std::move(guards), {}) &&
      !(holding_.largest_rate(here_.t, here_.state.alpha, here_.x) <= 1e-3 * rate)) {
    fail(Termination::outside_class,
         fmt::format("the jumps {} accumulate at t = {:.17g}, but their guards cannot be at rest at 0 together",
                     jump_names(jumps), here_.t));
  }
  if (!outcome_.running || !free_passing() || !decide_behind_jumps()) return accumulated();
  cascade_.give_directions();
  if (ends) jumps_.accept(limit.events, jump_point());
  accumulated();
  go_on_from_limit();
}

/// Skips to the limit of a sequence that is too fine to be followed; rows on the way have the last state.
void Run::pass_to(double t, const std::vector<double>& x) {
  rows_.each_before(here_.t, t, [&](double requested) { row(requested, here_.x); });
  const bool time_passes = t > here_.t;
  here_.move_to(t, here_.x.data());
  rows_.skip_here();
  if (time_passes) row(here_.t, here_.x);
  here_.move_to(t, x.data());
}

/// Events and jumps behind the limit of a sequence, and a step to start with.
void Run::go_on_from_limit() {
  static_cast<void>(user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs()));
  jumps_.update(jump_point());
  start_step();
  if (jumps_have_problem() || !jumps_.due(here_.t)) return;
  const Arrival arrival = arrive(OutputRows::Arrival::written);
  cascade_.begin();
  static_cast<void>(jump(event_.before, event_.x_before));
  static_cast<void>(depart(arrival));
}

}  // namespace saltus::event_integrator
