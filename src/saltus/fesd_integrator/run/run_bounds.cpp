// Selections that end at a bound where they have a double root.
#include <algorithm>

#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

std::vector<int> Run::on_surfaces() const {
  std::vector<int> list;
  for (const Sliding& entry : set_.sliding()) {
    list.push_back(entry.selection);
    if (entry.reference >= 0) list.push_back(entry.reference);
  }
  return list;
}

/// Near the double root alpha is the square root of time: it is known to the root of what time is known to, and no
/// element ends where it is zero.
bool Run::left_at_double_root() {
  if (propagation_ != nullptr) return false;  // its derivative by time is infinite there
  constexpr double near = 1e-5;
  const auto& conditions = set_.conditions();
  const bool at_bound = std::any_of(conditions.begin(), conditions.end(), [&](const Condition& condition) {
    return condition.kind != Condition::Kind::side &&
           set_.value(condition, at_switch_.indicator.data(), selections_.data()) <= near;
  });
  if (!at_bound) return false;
  const ActiveSet before = set_;
  const auto selections = selections_;
  decide(on_surfaces(), "a selection has a double root at its bound", before, selections, held_.data());
  row_here();
  return stopped() || undecided_ || !(set_ == before);
}

}  // namespace saltus::fesd_integrator
