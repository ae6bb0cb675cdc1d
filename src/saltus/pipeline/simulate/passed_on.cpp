#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "saltus/pipeline/simulate/passed_on_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::pipeline {

PassingOn::PassingOn(const Observers& observers, const result::Result& frame, std::optional<WantedRows> wanted)
    : observers_(observers), wanted_(std::move(wanted)), part_(frame) {
  known_.least.assign(frame.states.size(), std::numeric_limits<double>::infinity());
  known_.greatest.assign(frame.states.size(), -std::numeric_limits<double>::infinity());
}

void PassingOn::take(result::Trajectory rows, result::Events events) {
  if (wanted_) rows = without_event_rows(rows);
  pass(std::move(rows), std::move(events));
}

result::PassedOn PassingOn::end() {
  const bool stays = last_.t.empty() || wanted_->last || known_.rows == 0 || wanted_->has(last_.t.back());
  auto rows = std::exchange(last_, {});
  pass(stays ? std::move(rows) : result::Trajectory(), {});
  return std::move(known_);
}

void PassingOn::pass(result::Trajectory rows, result::Events events) {
  known_.rows += rows.t.size();
  known_.events += events.size();
  for (const auto& x : rows.x) widen(x);
  for (std::size_t i = 0; i < events.size(); ++i) {
    widen(events.x(i));
    widen(events.x_after(i));
    known_.alternatives += events.alternatives(i);
    ++known_.kinds[events.kind(i)];
  }
  if (part_.kept) result::keep_columns(*part_.kept, rows);
  part_.trajectory = std::move(rows);
  part_.events = std::move(events);
  observers_.on_part(part_);
}

void PassingOn::widen(std::span<const double> x) {
  for (std::size_t i = 0; i < std::min(x.size(), known_.least.size()); ++i) {
    if (!std::isfinite(x[i])) continue;
    known_.least[i] = std::min(known_.least[i], x[i]);
    known_.greatest[i] = std::max(known_.greatest[i], x[i]);
  }
}

/// The last row is kept back: whether it stays is known with the one behind it.
result::Trajectory PassingOn::without_event_rows(const result::Trajectory& rows) {
  result::Trajectory kept = std::exchange(last_, {});
  for (std::size_t row = 0; row < rows.t.size(); ++row) kept.append(rows, row);
  if (kept.t.empty()) return kept;
  last_.append(kept, kept.t.size() - 1);
  leave_out_event_rows({wanted_->times, true}, kept);
  std::vector<std::size_t> all_but_last(kept.t.size() - 1);
  std::iota(all_but_last.begin(), all_but_last.end(), std::size_t{0});
  kept.keep(all_but_last);
  return kept;
}

}  // namespace saltus::pipeline
