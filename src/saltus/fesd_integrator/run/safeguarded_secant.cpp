#include <algorithm>
#include <cmath>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/safeguarded_secant_internal.hpp"

namespace saltus::fesd_integrator {

/// Roundings of components much smaller than the largest are smaller than the noise, and divided by a small slope it is
/// a time.
bool SafeguardedSecant::is_polished(double value, double noise) {
  if (std::abs(value) > 0.25 * noise) return false;
  constexpr int most_polishing_steps = 3;
  const double end = start_.time + start_.elements * h_;
  const bool resolved = std::abs(value) * start_.elements <= 2.0 * rounding_unit * end * std::abs(slope_);
  const bool stalls = polished_ > 0 && std::abs(value) > 0.5 * std::abs(value_before_) && value * value_before_ > 0.0;
  if (resolved || stalls || polished_ == most_polishing_steps) return true;
  ++polished_;
  return false;
}

/// nullopt where the value is positive up to the longest h.
std::optional<double> SafeguardedSecant::next(double value) const {
  const bool bracketed = std::isfinite(upper_);
  const double step = slope_ < 0.0 ? h_ - value / slope_ : std::numeric_limits<double>::quiet_NaN();
  const double upper = bracketed ? upper_ : std::min(2.0 * h_, start_.longest);
  if (step > lower_ && step < upper) return step;
  if (!bracketed && h_ >= start_.longest) return std::nullopt;
  return bracketed ? 0.5 * (lower_ + upper_) : upper;
}

SafeguardedSecant::State SafeguardedSecant::take(double value, double noise) {
  constexpr int most_iterations = 60, most_unpolished = 8;
  if (!std::isfinite(value)) return State::none;
  if (upper_ - lower_ <= 4.0 * rounding_unit * h_ || is_polished(value, noise)) return State::found;
  (value > 0.0 ? lower_ : upper_) = h_;
  if (taken_ > 0 && h_ != h_before_ && value != value_before_) slope_ = (value - value_before_) / (h_ - h_before_);
  h_before_ = h_;
  value_before_ = value;
  const auto h = next(value);
  if (!h) return State::none;
  if (*h == h_ || (std::abs(value) <= noise && taken_ > most_unpolished)) return State::found;
  if (++taken_ == most_iterations) return State::none;
  h_ = *h;
  return State::searching;
}

}  // namespace saltus::fesd_integrator
