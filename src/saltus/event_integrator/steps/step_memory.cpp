#include "saltus/event_integrator/steps/step_memory.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/mode/mode_differences_internal.hpp"

namespace saltus::event_integrator {
namespace {

std::size_t weight(std::size_t surface) { return 0x9e3779b97f4a7c15U * (surface + 1); }
/// Modulo 2^64, as are sums of marks.
std::size_t unsigned_of(int difference) { return static_cast<std::size_t>(difference); }

std::size_t mark_of(const std::vector<int>& mode) {
  std::size_t mark = 0;
  for (std::size_t j = 0; j < mode.size(); ++j) mark += weight(j) * unsigned_of(mode[j]);
  return mark;
}

}  // namespace

/// Of the mode that lasts.
void StepMemory::end(double t) {
  // Longer than the mode lasted is no use: a step that reaches its end sees all of it, and far behind that end the
  // field of the mode may mean nothing.
  constexpr double beyond = 1.25;
  if (used_ != 0 && first_accepted_) entries_[current_].step = std::min(proposed_, beyond * (t - start_));
}

double StepMemory::begin(const std::vector<int>& mode, std::size_t mark, double t, double proposed) {
  start_ = t;
  first_accepted_ = false;
  for (current_ = 0; current_ < used_; ++current_) {
    const auto& entry = entries_[current_];
    if (entry.mark != mark || entry.mode != mode) continue;
    is_new_ = !(entry.step > 0.0);
    return is_new_ ? proposed : entry.step;
  }
  is_new_ = true;
  current_ = next_;
  next_ = (next_ + 1) % capacity;
  used_ = std::min(used_ + 1, capacity);
  entries_[current_].mark = mark;
  entries_[current_].mode = mode;
  entries_[current_].step = 0.0;
  return proposed;
}

double StepMemory::change(const std::vector<int>& mode, double t, double proposed, const ModeChange& change) {
  end(t);
  if (change.is_single() && used_ != 0) return begin(mode, mark_with(at(change.surface), change.after), t, proposed);
  // The mark of the mode before is known: what differs from it is added.
  std::size_t mark = used_ == 0 ? mark_of(mode) : entries_[current_].mark;
  if (used_ != 0) {
    const auto& before = entries_[current_].mode;
    for_each_difference(before, mode, [&](std::size_t j) { mark += weight(j) * unsigned_of(mode[j] - before[j]); });
  }
  return begin(mode, mark, t, proposed);
}

std::size_t StepMemory::mark_with(std::size_t surface, int mode) const {
  if (used_ == 0) return 0;
  const auto& entry = entries_[current_];
  return entry.mark + weight(surface) * unsigned_of(mode - entry.mode[surface]);
}

void StepMemory::accepted(double proposed) {
  if (first_accepted_) return;
  first_accepted_ = true;
  proposed_ = proposed;
}

}  // namespace saltus::event_integrator
