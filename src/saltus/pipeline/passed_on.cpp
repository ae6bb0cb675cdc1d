#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/pipeline/passed_on_internal.hpp"

namespace saltus::pipeline {

PassingOn::PassingOn(const Observers& observers, const result::Result& frame, const std::vector<double>* times)
    : observers_(observers), times_(times), part_(frame) {
  known_.least.assign(frame.states.size(), std::numeric_limits<double>::infinity());
  known_.greatest.assign(frame.states.size(), -std::numeric_limits<double>::infinity());
}

void PassingOn::take(result::Trajectory rows, result::Events events) {
  if (times_ != nullptr) rows = without_event_rows(rows);
  pass(std::move(rows), std::move(events));
}

result::PassedOn PassingOn::end() {
  pass(std::exchange(last_, {}), {});
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
  }
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

/// As leave_out_event_rows for the whole run.
result::Trajectory PassingOn::without_event_rows(const result::Trajectory& rows) {
  result::Trajectory kept;
  const auto look_at = [&](const result::Trajectory& of, std::size_t row, double next) {
    if (next == of.t[row]) return;
    if (times_->empty() || std::binary_search(times_->begin(), times_->end(), of.t[row])) kept.append(of, row);
  };
  if (rows.t.empty()) return kept;
  if (!last_.t.empty()) look_at(last_, 0, rows.t.front());
  const std::size_t last = rows.t.size() - 1;
  for (std::size_t row = 0; row < last; ++row) look_at(rows, row, rows.t[row + 1]);
  last_ = {};
  last_.append(rows, last);
  return kept;
}

}  // namespace saltus::pipeline
