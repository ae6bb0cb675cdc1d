// Modes that come back: sticking and slipping have two sets of functions, which are made once.
#include <algorithm>
#include <utility>

#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

ModeFunctions* KeptModes::find(const std::vector<int>& sliding) {
  const auto known =
      std::find_if(modes_.begin(), modes_.end(), [&](const auto& mode) { return mode.state.sliding == sliding; });
  return known == modes_.end() ? nullptr : &*known;
}

void KeptModes::keep(const ModeFunctions& mode) {
  constexpr std::size_t many = 8;
  if (modes_.size() < many) {
    modes_.push_back(mode);
  } else {
    modes_[next_] = mode;
    next_ = (next_ + 1) % many;
  }
}

void EventSearch::enter_again(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  if (state.sliding != mode_.state.sliding && mode_.flips && !mode_.state.higher) {
    mode_.forget_zeros(special_);
    special_.clear();
    if (auto* known = kept_.find(state.sliding)) {
      std::swap(mode_, *known);
      const std::size_t count = mode_.functions.size();
      for (auto* values : {&levels_.noise, &levels_.accuracy, &point_}) values->resize(std::max(values->size(), count));
      samples_.resize(std::max(samples_.size(), count * ode::event_nodes));
    } else {
      kept_.keep(mode_);
    }
  }
  enter(state, zero_order, t, x);
}

}  // namespace saltus::event_integrator
