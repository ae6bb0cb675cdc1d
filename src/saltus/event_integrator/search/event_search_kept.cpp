// Modes that come back: sticking and slipping have two sets of functions, which are made once.
#include <algorithm>
#include <utility>

#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

void EventSearch::exchange(Kept& kept) {
  std::swap(state_.mode, kept.state.mode);
  std::swap(state_.alpha, kept.state.alpha);
  std::swap(state_.sliding, kept.state.sliding);
  functions_.swap(kept.functions);
  exits_.swap(kept.exits);
  forms_.swap(kept.forms);
  curved_.swap(kept.curved);
  of_surface_.swap(kept.of_surface);
  std::swap(curved_parts_, kept.curved_parts);
  std::swap(first_exit_, kept.first_exit);
  std::swap(users_, kept.users);
  std::swap(users_end_, kept.users_end);
  std::swap(flips_, kept.flips);
  prefilter_.swap(kept.prefilter);
}

/// A copy of the functions of this mode.
void EventSearch::keep() {
  constexpr std::size_t many = 8;
  Kept kept{state_,        functions_,  exits_, forms_,     curved_, of_surface_,
            curved_parts_, first_exit_, users_, users_end_, flips_,  prefilter_};
  if (kept_.size() < many) {
    kept_.push_back(std::move(kept));
  } else {
    kept_[next_kept_] = std::move(kept);
    next_kept_ = (next_kept_ + 1) % many;
  }
}

void EventSearch::enter_again(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  if (state.sliding != state_.sliding && flips_ && !state_.higher) {
    forget_specials();
    special_.clear();
    const auto known =
        std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.state.sliding == state.sliding; });
    if (known == kept_.end()) {
      keep();
    } else {
      exchange(*known);
      const std::size_t count = functions_.size();
      for (auto* values : {&noise_, &accuracy_, &point_}) values->resize(std::max(values->size(), count));
      samples_.resize(std::max(samples_.size(), count * ode::event_nodes));
    }
  }
  enter(state, zero_order, t, x);
}

}  // namespace saltus::event_integrator
