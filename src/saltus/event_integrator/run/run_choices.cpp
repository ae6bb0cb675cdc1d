// Alternatives of decisions and members of families, followed instead of what was decided.
#include <utility>

#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// The time is that at which the run was asked to leave its mode as a member of a family.
void Run::leave_later() {
  const auto* family = choices_.departing();
  if (family == nullptr) return;
  run_.evaluate_here();
  const Position& here = run_.here;
  SwitchingPoint point;
  point.begin(here.t, here.x.data(), here.time_scale);
  point.at_zero = here.state.sliding;
  for (const auto& given : family->given) point.touched.push_back(given.surface);
  auto left = decide_with(run_.switching, here.state, point, family->given);
  if (!left) return;
  left->alternatives.emplace_back();
  left->alternatives.back().state = here.state;
  for (const auto& other : choices_.families().open()) {
    if (&other == family) continue;
    if (auto also = decide_with(run_.switching, here.state, point, other.given)) {
      left->alternatives.push_back(std::move(*also));
    }
  }
  left->unique = false;
  left->reason = "followed as a branch: leaves at one of the times at which it may" +
                 (left->reason.empty() ? "" : "; " + left->reason);
  come_to(Instant::Cause::departure);
  next_.instant->transition = std::move(*left);
  next_.departs = true;
}

}  // namespace saltus::event_integrator
