#include <algorithm>
#include <cmath>

#include "saltus/switching/hidden_recurrence_internal.hpp"

namespace saltus::switching {
namespace {

constexpr double close = 1e-6;         ///< a thousand times the integration's tolerance
constexpr double rounding = 1e-12;     ///< of closed forms, some laps long
constexpr double shrinking = 0.9;      ///< a factor per lap that truncation errors do not imitate
constexpr double affine_match = 1e-6;  ///< to which two factors of an affine return map agree
constexpr double neutral = 1e-7;       ///< factors closer to 1 are not told from it

double excursion(double u) { return std::max({0.0, -u, u - 1.0}); }

}  // namespace

Recurrence::Recurrence(int surfaces)
    : passages_(remembered),
      last_free_(static_cast<std::size_t>(surfaces), -1),
      integral_(static_cast<std::size_t>(surfaces)) {
  for (auto& passage : passages_) {
    passage.u.resize(integral_.size());
    passage.integral.resize(integral_.size());
  }
}

void Recurrence::visit(const std::vector<int>& zone, bool closed_form) {
  ++count_;
  for (std::size_t j = 0; j < zone.size(); ++j) {
    if (zone[j] == 0) last_free_[j] = count_;
  }
  if (!closed_form) last_interior_ = count_;
}

Lap Recurrence::compare(Passage& now, const Passage& before, std::size_t lag, const std::vector<int>& zone) const {
  Lap lap;
  double distance = 0.0;
  for (std::size_t j = 0; j < now.u.size(); ++j) {
    const double change = now.u[j] - before.u[j];
    if (last_free_[j] >= before.count) {
      distance = std::max(distance, std::abs(change));
    } else if (!(change * zone[j] > 0.0)) {
      return lap;  // coming back, sooner or later
    }
  }
  now.distance[lag] = distance;
  now.ratio[lag] = before.distance[lag] > 0.0 ? distance / before.distance[lag] : 0.0;
  now.compared[lag] = before.compared[lag] + 1;
  const double ratio = now.ratio[lag];
  const double ratio_before = before.ratio[lag];
  const double remaining = distance * ratio / (1.0 - ratio);
  const double size = 1.0 + now.amplitude;
  // The section was passed twice before, and only closed-form zones were visited during the laps in between.
  const bool affine = now.compared[lag] > 2 && std::abs(ratio - ratio_before) <= affine_match * ratio &&
                      last_interior_ < before.count - 2 * (now.count - before.count);
  if (now.compared[lag] > 1 && std::max(distance, before.distance[lag]) <= rounding * size) {
    lap.kind = Lap::Kind::cycle;
    lap.remaining = distance;
  } else if (affine && ratio > 1.0 + neutral && now.amplitude > before.amplitude) {
    lap.kind = Lap::Kind::spiral_out;
  } else if ((now.compared[lag] > 2 && distance <= close * size && std::max(ratio, ratio_before) <= shrinking) ||
             (affine && ratio < 1.0 - neutral && remaining < 0.01 * size)) {
    lap.kind = Lap::Kind::cycle;
    lap.remaining = remaining;
  }
  if (lap.kind == Lap::Kind::none) return lap;
  lap.side.resize(now.u.size());
  lap.mean.resize(now.u.size());
  for (std::size_t j = 0; j < now.u.size(); ++j) {
    lap.side[j] = last_free_[j] >= before.count ? 0 : zone[j];
    lap.mean[j] = (now.integral[j] - before.integral[j]) / (now.time - before.time);
  }
  return lap;
}

Lap Recurrence::pass(std::uint64_t section, const std::vector<double>& u, const std::vector<int>& zone) {
  Passage& now = passages_[next_ % remembered];
  now.section = section;
  now.count = count_;
  now.time = time_;
  now.amplitude = 0.0;
  for (std::size_t j = 0; j < u.size(); ++j) {
    now.u[j] = u[j];
    now.integral[j] = integral_[j];
    now.amplitude = std::max(now.amplitude, excursion(u[j]));
  }
  now.distance.fill(0.0);
  now.ratio.fill(0.0);
  now.compared.fill(0);
  Lap found;
  std::size_t lag = 0;
  const std::size_t oldest = next_ >= remembered ? next_ - remembered + 1 : 0;
  for (std::size_t i = next_; i > oldest && lag < lags && found.kind == Lap::Kind::none; --i) {
    const Passage& before = passages_[(i - 1) % remembered];
    if (before.section == section) found = compare(now, before, lag++, zone);
  }
  ++next_;
  return found;
}

}  // namespace saltus::switching
