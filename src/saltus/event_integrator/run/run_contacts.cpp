// Contacts in a run: where their modes change.
#include <utility>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

/// Modes at the start; bodies that touch and approach collide at once.
bool Run::begin_contacts(Landing& landing) {
  if (contacts_.none()) return true;
  const auto before = x_;
  if (auto problem = contacts_.resolve({t_, state_.alpha, h_scale_}, {}, x_)) {
    fail(Termination::outside_class, std::move(*problem));
    return false;
  }
  if (const auto jump = contacts_.jump_with_impulse(x_)) {
    ExecutedJump& executed = landing.executed.append();
    executed.x = before;
    executed.jump = *jump;
    executed.x_after = x_;
  }
  return true;
}

/// All contacts whose modes end here, at once.
bool Run::move_contacts() {
  const auto ended = contacts_.with_jumps([&](int jump) { return jumps_.holds(jump); });
  auto problem = contacts_.resolve({t_, state_.alpha, h_scale_}, ended, x_);
  if (problem) fail(Termination::outside_class, std::move(*problem));
  return !problem;
}

/// Behind the limit of a sequence of bounces the gaps are closed.
void Run::settle_contacts(const SeriesLimit& limit, const std::vector<double>& x_last, const ModeState& before) {
  jump_series_.clear();
  pass_to(limit.t, limit.x);
  contacts_.copy_modes(x_last, x_);
  contacts_.forget_impulses(x_);
  Landing& landing = landing_here();
  auto problem = contacts_.settle({t_, state_.alpha, h_scale_}, limit.events, x_);
  if (problem) fail(Termination::outside_class, std::move(*problem));
  const auto accumulated = [&] {
    recorder_.accumulated(t_, limit.events, {x_last, x_, before, state_},
                          "the intervals of these impacts shrink geometrically: the gaps close in their limit");
    row(t_, x_);
    last_event_time_ = t_;
  };
  if (!running_) return accumulated();
  drop_zeros(landing);
  read_user_signs(landing);
  if (!decide_behind_jumps(landing)) return accumulated();
  give_directions(landing);
  accumulated();
  go_on_from_limit();
}

}  // namespace saltus::event_integrator
