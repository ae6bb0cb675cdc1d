// Functions that hold the signs of surfaces that are slid on: they have one value in each of the regions that meet
// there.
#include <algorithm>
#include <utility>

#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

namespace {

bool holds_nested(const HigherOrderSet& set, int function) {
  return std::any_of(set.nested.begin(), set.nested.end(), [&](const auto& n) { return n.function == function; });
}

}  // namespace

/// Sets up the nested functions of a mode, in each of their regions.
void EventSearch::enter_nested(const ModeState& state, const std::vector<int>& zero_order) {
  values_.corners.clear();
  if (!any_nesting_ || state.sliding.empty()) return;
  const bool single = state.sliding.size() == 1;
  const auto add = [&](std::vector<double> alpha) {
    values_.corners.push_back({std::move(alpha), std::vector<double>(at(kernel_.event_functions())), {}});
  };
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (state.mode[at(j)] == 0 || !nesting_[at(j)] || sliding_inside(kernel_, state, j).empty()) continue;
    const bool known = single && !values_.corners.empty();
    const std::size_t first = known ? 0 : values_.corners.size();
    if (!known) {
      for (auto& alpha : corners_inside(kernel_, state, j)) {
        if (state.higher) read_nested(state.higher->nested, alpha);
        add(std::move(alpha));
      }
    }
    for (std::size_t corner = first; corner < values_.corners.size(); ++corner) {
      // Of several surfaces all regions have the sign of the mode, or what is held says which one they have.
      const bool by_region = single || (state.higher && holds_nested(*state.higher, j));
      const int sign = !by_region ? state.mode[at(j)] : values_.corners[corner].alpha[at(j)] > 0.5 ? 1 : -1;
      mode_.functions.push_back({FunctionKind::nested, j, static_cast<int>(corner), sign, zero_order[at(j)]});
    }
  }
}

}  // namespace saltus::event_integrator
