#include "saltus/event_integrator/accumulate/switch_series.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/contracts.hpp"

namespace saltus::event_integrator {
namespace {

/// Of the span: no model lives on that scale.
constexpr double shortest_scale = 1e-9;

}  // namespace

bool SwitchSeries::note(double t, const ModeChange& change) {
  if (!change.is_single() && change.mode_before->mode == change.mode_after->mode) return false;
  remember(t);
  if (t != last_) begin_anew();
  last_ = t;
  if (!change.is_single()) return is_loop(change.mode_before->mode, change.mode_after->mode);
  SALTUS_ASSERT(changes_.empty() && !surface_change_);
  surface_change_ = {at(change.surface), change.before};
  return false;
}

/// Whether this change was made at last_ already; notes it.
bool SwitchSeries::is_loop(const std::vector<int>& before, const std::vector<int>& after) {
  if (surface_change_) {
    auto& change = changes_.append();
    change.first = change.second = before;
    change.first[surface_change_->first] = surface_change_->second;
    surface_change_.reset();
  }
  const auto known = changes_.items();
  const auto same = [&](const Change& change) { return change.first == before && change.second == after; };
  if (std::any_of(known.begin(), known.end(), same)) return true;
  auto& change = changes_.append();
  change.first = before;
  change.second = after;
  return false;
}

void SwitchSeries::remember(double t) {
  std::copy_backward(times_.begin(), times_.end() - 1, times_.end());
  times_[0] = t;
  ++switches_;
  const double before = times_[4] - times_[8];
  if (switches_ <= 8 || !(t - times_[4] < before)) {
    first_cycle_ = 0.0;
  } else if (first_cycle_ == 0.0) {
    first_cycle_ = before;
  }
}

bool SwitchSeries::shrinks(double t) const {
  // Two cycles within a few digits of t are what a sequence leaves that is lost in its rounding.
  constexpr double unresolved = 128.0 * rounding_unit;
  if (switches_ > 4 && t - times_[4] <= unresolved * std::abs(t)) return true;
  // The last terms of a geometric series are lost in the rounding of t: a fast one is over after a few, and with more
  // in a cycle a slow one shrinks by half from cycle to cycle.
  for (const std::size_t cycle : {std::size_t{2}, std::size_t{4}}) {
    if (switches_ <= 2 * cycle || t - times_[cycle] > shortest_scale * span_) continue;
    if (times_[0] - times_[cycle] <= 0.5 * (times_[cycle] - times_[2 * cycle])) return true;
  }
  return false;
}

bool SwitchSeries::tightens() const {
  for (std::size_t cycle = 1; cycle <= 4 && switches_ > 2 * cycle; ++cycle) {
    // Where a limit cycle is approached, cycles have nearly one length.
    if (times_[0] - times_[cycle] < 0.995 * (times_[cycle] - times_[2 * cycle])) return true;
  }
  // Those of a slow spiral shrink without end.
  return times_[0] - times_[4] < 0.5 * first_cycle_;
}

bool SwitchSeries::too_dense(double t) {
  // 500 switches on that scale: a spiral or a Zeno sequence.
  if (in_a_row_ == 0 || t - start_ > shortest_scale * span_) {
    in_a_row_ = 0;
    start_ = t;
  }
  return ++in_a_row_ >= 500;
}

}  // namespace saltus::event_integrator
