#include "saltus/event_integrator/sequences/jump_accumulation.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// Between two zeros a time T apart a guard gets about as far as its rate times T/4: here 200 roundings.
constexpr double unresolved = 800.0 * rounding_of(1.0);

}  // namespace

JumpAccumulation::JumpAccumulation(const SwitchingContext& switching_context, const Position& here)
    : layout_(switching_context.layout),
      kernel_(switching_context.kernel),
      here_(here),
      last_guard_(layout_.jumps.size()),
      last_rate_(layout_.jumps.size(), 0.0),
      shortest_cycle_(layout_.jumps.size(), 0.0),
      magnitude_(at(kernel_.event_functions())),
      slope_(magnitude_.size()) {}

void JumpAccumulation::note(const JumpCascade& cascade, const Jumps& jumps) {
  if (cascade.executed().empty()) return;
  const JumpPoint point = cascade.jump_point();
  kernel_.scales(here_.t, here_.x.data(), here_.state.alpha.data(), magnitude_.data(), slope_.data());
  executed_.clear();
  for (const auto& executed : cascade.executed().items()) executed_.push_back(executed.jump);
  for (const int jump : executed_) {
    for (int g = 0; g < static_cast<int>(layout_.jumps[at(jump)].guards.size()); ++g) {
      const int function = kernel_.jump_guard(jump, g);
      if (!contains(point.zeros, function) || jumps.is_discrete_guard(function)) continue;
      const int inward = jumps.trigger_sign(jump, g, point, -point.signs[at(function - kernel_.switching_functions())]);
      last_guard_[at(jump)] = HeldGuard{{jump, function}, inward};
      const double rate = cascade.rate(function);
      last_rate_[at(jump)] = rate;
      shortest_cycle_[at(jump)] = rate > 0.0 ? unresolved * magnitude_[at(function)] / rate : 0.0;
    }
  }
  note_bounces(cascade);
  series_.add(here_.t, executed_, here_.x);
  if (!cascade.resting().empty()) series_.clear_cycles();
}

/// Impacts leave gaps at 0 with rates that may be 0: what counts is how fast they closed.
void JumpAccumulation::note_bounces(const JumpCascade& cascade) {
  for (const auto& executed : cascade.executed().items()) {
    if (!cascade.contacts().owns(executed.jump)) continue;
    Contacts::Along along;
    const auto gap = cascade.contacts().gap_motion(kernel_.jump_guard(executed.jump, 0),
                                                   {here_.t, here_.state.alpha, here_.time_scale}, executed.activities,
                                                   executed.x, here_.slope, along);
    if (!gap) continue;
    shortest_cycle_[at(executed.jump)] = gap->rate != 0.0 ? unresolved * gap->size / std::abs(gap->rate) : 0.0;
  }
}

void JumpAccumulation::end(const SeriesLimit& limit) {
  if (limit.kind == SeriesKind::chattering) {
    series_.clear();
  } else {
    series_.clear_cycles();
  }
}

}  // namespace saltus::event_integrator
