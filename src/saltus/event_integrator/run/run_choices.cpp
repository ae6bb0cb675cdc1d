// Alternatives of decisions and members of families, followed instead of what was decided.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// The time is that at which the run was asked to leave its mode as a member of a family.
Run::Step Run::leave_later() {
  const auto* family = choices_.departing();
  if (family == nullptr) return Step::taken;
  const Arrival arrival =
      arrive(recorder_.ends_at(here_.t) ? OutputRows::Arrival::written : OutputRows::Arrival::missing);
  SwitchingPoint& switching_point = event_.switching_point;
  switching_point.begin(here_.t, here_.x.data(), here_.time_scale);
  switching_point.at_zero = here_.state.sliding;
  for (const auto& given : family->given) switching_point.touched.push_back(given.surface);
  auto left = decide_with(switching_context_, event_.before, switching_point, family->given);
  if (!left) return Step::taken;
  left->alternatives.emplace_back();
  left->alternatives.back().state = event_.before;
  for (const auto& other : choices_.families().open()) {
    if (&other == family) continue;
    if (auto also = decide_with(switching_context_, event_.before, switching_point, other.given)) {
      left->alternatives.push_back(std::move(*also));
    }
  }
  left->unique = false;
  left->reason = "followed as a branch: leaves at one of the times at which it may" +
                 (left->reason.empty() ? "" : "; " + left->reason);
  event_.transition = std::move(*left);
  choices_.depart(progress());
  static_cast<void>(go_on());
  return depart(arrival);
}

}  // namespace saltus::event_integrator
