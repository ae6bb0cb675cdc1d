#include "saltus/fesd_integrator/accumulate/cycle_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/ode/geometric_limit.hpp"

namespace saltus::fesd_integrator {

void CycleSeries::clear() {
  switches_.clear();
  count_.fill(0);
}

void CycleSeries::add(Switch next) {
  switches_.push_back(std::move(next));
  if (switches_.size() > longest_period * cycles + 1) switches_.pop_front();
  const double t = back(0).t;
  for (std::size_t period = 1; period <= longest_period && period < switches_.size(); ++period) {
    const bool repeats = back(0).modes == back(period).modes;
    const bool shorter =
        repeats && switches_.size() > 2 * period && t - back(period).t < back(period).t - back(2 * period).t;
    if (count_[period] == 0 || !shorter) {
      start_[period] = back(period).t;
      count_[period] = repeats ? 1 : 0;
    } else {
      ++count_[period];
    }
  }
}

bool CycleSeries::shrinks() const {
  for (std::size_t period = 1; period <= longest_period; ++period) {
    if (count_[period] > period) return true;
  }
  return false;
}

std::optional<double> CycleSeries::next_switch() const {
  if (switches_.size() < 3) return std::nullopt;
  const double last = back(0).t - back(1).t, before = back(1).t - back(2).t;
  constexpr double shrinking = 0.7;
  return last > 0.0 && last < shrinking * before ? std::optional(last * last / before) : std::nullopt;
}

double CycleSeries::last_change() const {
  for (std::size_t period = 1; period <= longest_period; ++period) {
    if (count_[period] <= period) continue;
    double largest = 0.0;
    for (std::size_t i = 0; i < back(0).x.size(); ++i) {
      largest = std::max(largest, std::abs(back(0).x[i] - back(period).x[i]));
    }
    return largest;
  }
  return 0.0;
}

std::optional<CycleSeries::Limit> CycleSeries::limit_of(std::size_t period, Wanted wanted) const {
  if (count_[period] < (cycles - 1) * period || switches_.size() <= 3 * period) return std::nullopt;
  const auto cycle = [&](std::size_t k) { return back(k * period).t - back((k + 1) * period).t; };
  Limit limit{back(0).t, back(0).x, {}};
  double resolution = 16.0 * std::numeric_limits<double>::epsilon() * std::abs(limit.t);
  for (std::size_t k = 0; k < period; ++k) {
    limit.modes.push_back(back(k).modes);
    resolution = std::max(resolution, back(k).resolution);
  }
  const double ratio = cycle(0) / cycle(1), ratio_before = cycle(1) / cycle(2);
  if (!(ratio < 1.0 && ratio_before < 1.0)) return std::nullopt;
  const double remaining = cycle(0) * ratio / (1.0 - ratio);
  const double remaining_before = cycle(1) * ratio_before / (1.0 - ratio_before);
  constexpr double resolved = 1000.0;
  const bool near = remaining <= 1e-8 * (limit.t - start_[period]) || cycle(0) <= resolved * resolution;
  if (!near && wanted == Wanted::resolved) return std::nullopt;
  const double difference = (limit.t + remaining) - (back(period).t + remaining_before);
  if (std::abs(difference) > 0.02 * remaining + 4.0 * resolution) return std::nullopt;
  limit.t += remaining;
  for (std::size_t i = 0; i < limit.x.size(); ++i) {
    limit.x[i] = ode::geometric_limit({back(2 * period).x[i], back(period).x[i], limit.x[i]}, ratio);
  }
  return limit;
}

std::optional<CycleSeries::Limit> CycleSeries::limit(Wanted wanted) const {
  for (std::size_t period = 1; period <= longest_period; ++period) {
    if (auto found = limit_of(period, wanted)) return found;
  }
  return std::nullopt;
}

}  // namespace saltus::fesd_integrator
