// A jump that takes back at once what the motion does.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/instant/jump_cascade.hpp"

namespace saltus::event_integrator {
namespace {

using model::JumpTrigger;

/// Whether a jump has set a state to what it was, to its rounding and what location leaves.
bool sets_the_same(const ExecutedJump& executed, std::size_t state, double left) {
  const double size = std::max(std::abs(executed.x[state]), std::abs(executed.x_after[state]));
  return std::abs(executed.x_after[state] - executed.x[state]) <= 64.0 * rounding_unit * size + left;
}

}  // namespace

/// Whether a guard at zero is left there by a jump that sets states in it which move, and the motion leads through at
/// once.
bool JumpCascade::is_taken_back(const ExecutedJump& executed, int guard) {
  const int function = kernel_.jump_guard(executed.jump, guard);
  if (!ledger_.has(function) || holding_.holds(function) || jumps_.is_discrete_guard(function)) return false;
  const auto& entry = switching_context_.layout.jumps[at(executed.jump)];
  const double left = 64.0 * rounding_unit * std::abs(here_.t) * rate(function);
  const auto kept = [&](int state) { return sets_the_same(executed, at(state), left); };
  const bool nothing_else = std::all_of(entry.targets.begin(), entry.targets.end(), kept);
  if (entry.trigger != JumpTrigger::condition && !nothing_else) return false;
  double in_time = 0.0;
  std::vector<double> gradient(here_.x.size());
  kernel_.gradient(function, here_.t, here_.x.data(), here_.state.alpha.data(), gradient.data(), &in_time);
  const bool sets_it = std::any_of(entry.targets.begin(), entry.targets.end(), [&](int state) {
    return gradient[at(state)] != 0.0 && slope_[at(state)] != 0.0 && kept(state);
  });
  if (!sets_it) return false;
  const Motion motion = motion_of(function);
  const int drift = static_cast<int>(motion.side.drift);
  return motion.order == 1 && drift != 0 && jumps_.trigger_sign(executed.jump, guard, jump_point(), drift) == drift;
}

std::optional<int> JumpCascade::endless_jump() {
  for (const auto& executed : executed_.items()) {
    if (contacts_.owns(executed.jump)) continue;
    const int guards = static_cast<int>(switching_context_.layout.jumps[at(executed.jump)].guards.size());
    for (int guard = 0; guard < guards; ++guard) {
      if (is_taken_back(executed, guard)) return executed.jump;
    }
  }
  return std::nullopt;
}

}  // namespace saltus::event_integrator
