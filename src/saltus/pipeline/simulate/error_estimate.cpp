#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "saltus/pipeline/simulate/error_estimate_internal.hpp"

namespace saltus::pipeline {
namespace {

/// Whether two events are the same one.
bool are_one(const result::Event& a, const result::Event& b) {
  return a.kind == b.kind && a.name == b.name && a.mode_after == b.mode_after;
}

std::size_t shared_events(const result::Events& a, const result::Events& b) {
  const std::size_t most = std::min(a.size(), b.size());
  std::size_t shared = 0;
  while (shared < most && are_one(a[shared], b[shared])) ++shared;
  return shared;
}

std::vector<double> distance(std::span<const double> a, std::span<const double> b) {
  std::vector<double> result(a.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) result[i] = std::abs(a[i] - b[i]);
  return result;
}

/// Of a list: those that a trajectory keeps.
std::vector<double> kept(const std::vector<double>& x, const std::optional<result::KeptColumns>& columns) {
  if (!columns) return x;
  std::vector<double> result;
  for (const std::size_t state : columns->states) result.push_back(x[state]);
  return result;
}

/// Events of one time, as numbers.
struct Instant {
  std::size_t first = 0, last = 0;
};

/// The events at a time, from a number on; nullopt without.
std::optional<Instant> events_at(const result::Events& events, double t, std::size_t& next) {
  while (next < events.size() && events[next].t < t) ++next;
  if (next == events.size() || events[next].t != t) return std::nullopt;
  Instant found{next, next};
  while (found.last + 1 < events.size() && events[found.last + 1].t == t) ++found.last;
  return found;
}

/// Times of rows that are at no event, each once.
std::vector<double> times_between_events(const result::Result& result) {
  std::vector<double> times;
  std::size_t next = 0;
  for (const double t : result.trajectory.t) {
    if (events_at(result.events, t, next) || (!times.empty() && times.back() == t)) continue;
    times.push_back(t);
  }
  return times;
}

/// Errors of all rows, by the rows of the second run in their order, or by its events.
std::vector<std::vector<double>> errors_of_rows(const result::Result& result, const result::Result& close,
                                                std::size_t shared) {
  const auto& rows = result.trajectory;
  const auto& others = close.trajectory;
  std::vector<std::vector<double>> errors;
  std::size_t next = 0, other = 0;
  for (std::size_t row = 0; row < rows.t.size(); ++row) {
    const auto here = events_at(result.events, rows.t[row], next);
    if (!here) {
      while (other < others.t.size() && others.t[other] < rows.t[row]) ++other;
      const bool found = other < others.t.size() && others.t[other] == rows.t[row];
      errors.push_back(
          distance(rows.x[row], found ? std::span<const double>(others.x[other]) : std::span<const double>()));
    } else if (here->last >= shared) {
      errors.push_back(distance(rows.x[row], {}));
    } else {
      const auto& x = result::side(rows, row) == 0 ? close.events[here->first].x : close.events[here->last].x_after;
      errors.push_back(distance(rows.x[row], kept(x, result.kept)));
    }
  }
  return errors;
}

/// What decides the error becomes so much smaller: tolerances, the width of what is smoothed, steps of elements, whose
/// work grows with their number.
double refine(SimulateOptions& options) {
  constexpr double tolerances = 0.01;
  constexpr long steps = 5;
  const bool has_elements = options.method == Method::fesd || options.method == Method::timestepping;
  if (!has_elements) {
    options.rtol *= tolerances;
    options.atol *= tolerances;
    if (options.method == Method::smoothed) options.smoothed.epsilon *= tolerances;
    return tolerances;
  }
  long& number = (options.method == Method::fesd ? options.fesd : options.timestepping).steps;
  number *= steps;
  options.max_steps = std::min(options.max_steps, std::numeric_limits<long>::max() / steps) * steps;
  return 1.0 / steps;
}

}  // namespace

Expected<result::ErrorEstimate> estimate_errors(const result::Result& result, SimulateOptions options,
                                                const SimulateAgain& again) {
  result::ErrorEstimate estimate;
  estimate.ratio = refine(options);
  options.output = AtTimes{times_between_events(result)};
  options.event_rows = false;
  options.error_estimate = options.continuous = false;
  options.event.trajectories = 1;
  const auto close = again(options);
  if (!close) return tl::unexpected(close.error());
  const std::size_t shared = shared_events(result.events, close->events);
  if (shared < std::max(result.events.size(), close->events.size())) estimate.parted_at = shared;
  for (std::size_t k = 0; k < shared; ++k)
    estimate.event_times.push_back(std::abs(result.events[k].t - close->events[k].t));
  estimate.x = errors_of_rows(result, *close, shared);
  estimate.final = distance(result.final.x, close->final.t == result.final.t ? std::span<const double>(close->final.x)
                                                                             : std::span<const double>());
  return estimate;
}

}  // namespace saltus::pipeline
