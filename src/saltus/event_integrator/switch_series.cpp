#include "saltus/event_integrator/switch_series.hpp"

#include <algorithm>

namespace saltus::event_integrator {

bool SwitchSeries::repeats(double t, const std::vector<int>& before, const std::vector<int>& after) {
  if (before == after) return false;
  if (t != last_) changes_.clear();
  last_ = t;
  Change change{before, after};
  if (std::find(changes_.begin(), changes_.end(), change) != changes_.end()) return true;
  changes_.push_back(std::move(change));
  return false;
}

bool SwitchSeries::too_dense(double t) {
  // 500 switches within 1e-9 of the span: no model lives on that scale, a spiral or Zeno sequence does.
  if (in_a_row_ == 0 || t - start_ > 1e-9 * span_) {
    in_a_row_ = 0;
    start_ = t;
  }
  return ++in_a_row_ >= 500;
}

}  // namespace saltus::event_integrator
