#include "saltus/event_integrator/accumulate/accumulation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/ode/geometric_limit.hpp"

namespace saltus::event_integrator {
namespace {

constexpr double hundredth = 0.01;
/// Cycles that shrink fast are short where they are less than this part of the time taken.
constexpr double short_cycle = 1e-6;
/// Of the time taken: what may remain behind too few cycles to believe in a limit.
constexpr double most_remaining = 1e-7;

/// What remains before a limit is asked for: of the time taken, and of what t resolves.
double least_remaining(double taken, double resolution) {
  constexpr double part = 1e-8, roundings = 100.0;
  return std::max(part * taken, roundings * resolution);
}

}  // namespace

void EventSeries::Executed::set(const std::vector<int>& executed) {
  if (executed.size() == 1) {
    only = executed.front();
  } else {
    only = several;
    jumps = executed;
  }
}

void EventSeries::Executed::append_to(std::vector<int>& list) const {
  if (only != several) {
    list.push_back(only);
  } else {
    list.insert(list.end(), jumps.begin(), jumps.end());
  }
}

double EventSeries::Executed::largest(const std::vector<double>& values) const {
  if (only != several) return std::max(0.0, values[at(only)]);
  double result = 0.0;
  for (const int jump : jumps) result = std::max(result, values[at(jump)]);
  return result;
}

void EventSeries::clear() {
  clear_cycles();
  recent_.clear();
}

void EventSeries::clear_cycles() {
  entries_.clear();
  std::fill(std::begin(cycles_), std::end(cycles_), std::size_t{0});
  shortest_repeated_ = 0;
  shrinks_ = is_sequence_ = false;
}

void EventSeries::add(double t, const std::vector<int>& jumps, const std::vector<double>& x) {
  Recent& recent = recent_.append();
  recent.t = t;
  recent.executed.set(jumps);
  Entry& entry = entries_.append();
  entry.t = t;
  entry.executed.set(jumps);
  if (!entry.place) {
    n_x_ = x.size();
    if (states_.empty()) states_.reserve(entries_.first_items * n_x_);
    entry.place = states_.size();
    states_.resize(states_.size() + n_x_);
  }
  std::copy(x.begin(), x.end(), states_.begin() + static_cast<std::ptrdiff_t>(*entry.place));
  std::copy_backward(lately_.begin(), lately_.end() - 1, lately_.end());
  lately_[0] = entry.executed.only;
  shortest_repeated_ = 0;
  shrinks_ = is_sequence_ = false;
  for (std::size_t period = 1; period <= longest_period && entries_.size() > period; ++period) {
    if (lately_[period] != lately_[0] || !repeats(0, period)) {
      cycles_[period] = 0;
      continue;
    }
    if (shortest_repeated_ == 0) shortest_repeated_ = period;
    const double before = back(period).t;
    const bool shrinks = entries_.size() > 2 * period && t - before < before - back(2 * period).t;
    if (cycles_[period] == 0 || !shrinks) {
      start_[period] = before;
      cycles_[period] = 1;
    } else {
      ++cycles_[period];
    }
    shrinks_ = shrinks_ || cycles_[period] >= 2;
    is_sequence_ = is_sequence_ || cycles_[period] >= 2 * period;
  }
}

EventSeries::Durations EventSeries::durations(std::size_t period, std::size_t skipped, std::size_t most) const {
  Durations result;
  for (std::size_t cycle = skipped; cycle < skipped + most && (cycle + 1) * period < entries_.size(); ++cycle) {
    if (!repeats(cycle * period, (cycle + 1) * period)) break;
    const double duration = back(cycle * period).t - back((cycle + 1) * period).t;
    // Before the sequence began to shrink its durations say nothing.
    if (result.count > 0 && !(duration > result.of[result.count - 1])) break;
    result.of[result.count++] = duration;
  }
  return result;
}

double EventSeries::ratio(std::size_t period, std::size_t skipped) const {
  const auto last = durations(period, skipped, 2);
  const double first = last.of[0] / last.of[1];
  if (!(first < 1.0)) return first;
  const double wanted = std::min(std::ceil(1.0 / (1.0 - first)), static_cast<double>(most_cycles));
  const auto all = durations(period, skipped, std::min(static_cast<std::size_t>(wanted) + 1, most_cycles));
  const double cycles = std::min(wanted, static_cast<double>(all.count - 1));
  return std::pow(all.of[0] / all.of[static_cast<std::size_t>(cycles)], 1.0 / cycles);
}

std::vector<double> EventSeries::extrapolated(std::size_t period, double ratio) const {
  std::vector<double> x = last_state();
  const double* earlier = state(period);
  const double* first = state(2 * period);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = ode::geometric_limit({first[i], earlier[i], x[i]}, ratio);
  }
  return x;
}

std::vector<int> EventSeries::last_jumps(std::size_t entries) const {
  std::vector<int> result;
  for (std::size_t k = 0; k < entries; ++k) {
    back(k).executed.append_to(result);
  }
  drop_repeats(result);
  return result;
}

/// Whether so much time remains that limit_of would say nothing, whatever the ratio that it would find. That one is a
/// mean of successive ratios over some cycles, which shrink: at least the last of them over all of them together.
bool EventSeries::is_far_from_limit(std::size_t period, double resolved_to) const {
  const double t = back(0).t;
  const double resolution = rounding_unit * std::abs(t);
  const double last = t - back(period).t;
  if (!(last > std::max(16.0 * resolution, resolved_to))) return false;
  const double before = back(period).t - back(2 * period).t;
  if (!(last < before)) return true;
  if (last * (last / before) <= resolved_to) return false;
  const auto cycles = static_cast<std::size_t>(std::min(std::ceil(before / (before - last)), double{most_cycles})) + 2;
  const double others = back(period).t - back(std::min(cycles * period, entries_.size() - 1)).t;
  // With twice what they are compared with the roundings of the ratio do not matter.
  return last * last > 2.0 * others * least_remaining(t - start_[period], resolution);
}

/// @param resolved_to  how long the cycles are that are lost in roundings
std::optional<SeriesLimit> EventSeries::limit_of(std::size_t period, double resolved_to) const {
  const auto now = durations(period, 0, fewest_cycles);
  const double t = back(0).t;
  const double resolution = rounding_unit * std::abs(t);
  if (now.count >= 2 && now.of[0] <= std::max(16.0 * resolution, hundredth * resolved_to)) {
    // Cycles that shrink fast leave little, but not nothing. Long ones are here because psi leaves its surface
    // tangentially, with no rate: their limit is where they are.
    const double fast = now.of[0] / now.of[1];
    if (!(fast <= 0.5 && now.of[0] <= short_cycle * (t - start_[period]))) {
      return SeriesLimit{t, last_state(), last_jumps(period), now.of[0]};
    }
    const double left = now.of[0] * fast / (1.0 - fast);
    return SeriesLimit{t + left, extrapolated(period, fast), last_jumps(period), now.of[0]};
  }
  // Of cycles that shrink to a tenth each the next one may be unresolved before there were four.
  const bool is_fast = now.count >= 3 && now.of[0] <= 0.1 * now.of[1] && now.of[1] <= 0.1 * now.of[2] &&
                       now.of[0] * (now.of[0] / now.of[1]) <= resolved_to;
  const bool is_unresolved = is_fast || now.of[0] <= resolved_to;
  const std::size_t fewest = is_fast ? fewest_cycles - 1 : fewest_cycles;
  // The first of several cycles does not count among those that have shrunk.
  if (cycles_[period] < (is_fast ? fewest - 1 : fewest) * period || now.count < fewest) return std::nullopt;
  const double ratio_now = ratio(period, 0);
  if (!(ratio_now < 1.0)) return std::nullopt;
  const double remaining = now.of[0] * ratio_now / (1.0 - ratio_now);
  const double taken = t - start_[period];
  if (remaining > least_remaining(taken, resolution) && !is_unresolved) return std::nullopt;
  const double ratio_before = ratio(period, 1);
  if (!(ratio_before < 1.0)) return std::nullopt;
  const double remaining_before = now.of[1] * ratio_before / (1.0 - ratio_before);
  // A fiftieth of what remains is 2e-10 of the time taken. The last of fast cycles is to be what those before foretold,
  // but for the quarter that rounding may make of it: the next one, a tenth as long, would be nothing else.
  const double expected = is_fast ? 0.25 * now.of[0] : 0.02 * remaining;
  const double difference = (t + remaining) - (back(period).t + remaining_before);
  if (std::abs(difference) > expected + 4.0 * resolution) return std::nullopt;
  return SeriesLimit{t + remaining, extrapolated(period, ratio_now), last_jumps(period), now.of[0]};
}

std::optional<SeriesLimit> EventSeries::end_of_chattering(const std::vector<double>& shortest) const {
  if (recent_.size() < many || entries_.empty()) return std::nullopt;
  const double t = recent_.back(0).t;
  const double taken = t - recent_.front().t;
  constexpr std::size_t few = 8;
  if (shortest.size() <= few) {  // the usual answer, without a look at each of them
    const double most = shortest.empty() ? 0.0 : *std::max_element(shortest.begin(), shortest.end());
    if (taken > static_cast<double>(many) * std::max(16.0 * rounding_unit * std::abs(t), hundredth * most)) {
      return std::nullopt;
    }
  }
  double resolved_to = 0.0;
  for (std::size_t k = 0; k < recent_.size(); ++k) {
    resolved_to = std::max(resolved_to, recent_.back(k).executed.largest(shortest));
  }
  const double resolved = std::max(16.0 * rounding_unit * std::abs(t), hundredth * resolved_to);
  if (taken > static_cast<double>(many) * resolved) return std::nullopt;
  std::vector<int> jumps;
  for (std::size_t k = 0; k < recent_.size(); ++k) {
    recent_.back(k).executed.append_to(jumps);
  }
  drop_repeats(jumps);
  return SeriesLimit{t, last_state(), std::move(jumps), resolved, SeriesKind::chattering};
}

std::optional<SeriesLimit> EventSeries::limit(const std::vector<double>& shortest) const {
  double resolved_to = 0.0;
  for (std::size_t period = 1; is_sequence_ && period <= longest_period && entries_.size() > 2 * period; ++period) {
    resolved_to = std::max(resolved_to, back(period - 1).executed.largest(shortest));
    // Every jump of the cycle has shrunk from cycle to cycle: cycles_ counts entries.
    if (cycles_[period] < 2 * period || is_far_from_limit(period, resolved_to)) continue;
    if (auto found = limit_of(period, resolved_to)) return found;
  }
  return end_of_chattering(shortest);
}

std::optional<SeriesLimit> EventSeries::nearly() const {
  if (shortest_repeated_ == 0) return std::nullopt;
  for (std::size_t period = shortest_repeated_; period <= longest_period && entries_.size() > 2 * period; ++period) {
    if (!repeats(0, period) || !repeats(period, 2 * period)) continue;
    const double cycle = back(0).t - back(period).t;
    const double before = back(period).t - back(2 * period).t;
    if (!(before > cycle)) continue;
    // Of a shorter period that repeats, too, the longer ones are multiples.
    if (!(cycle <= hundredth * before)) return std::nullopt;
    // What would remain.
    if (cycle * (cycle / before) <= most_remaining * (back(0).t - entries_.front().t)) {
      return SeriesLimit{back(0).t, last_state(), last_jumps(period), cycle};
    }
  }
  return std::nullopt;
}

std::optional<double> EventSeries::closed_cycle() const {
  if (shortest_repeated_ == 0) return std::nullopt;
  return back(0).t - back(shortest_repeated_).t;
}

std::optional<double> EventSeries::last_cycle() const {
  for (std::size_t period = 1; period <= longest_period; ++period) {
    if (cycles_[period] >= 2 * period && entries_.size() > period) return back(0).t - back(period).t;
  }
  return std::nullopt;
}

}  // namespace saltus::event_integrator
