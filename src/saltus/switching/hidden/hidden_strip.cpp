#include <cmath>

#include "saltus/switching/hidden/hidden_strip_internal.hpp"

namespace saltus::switching {
namespace {

/// (exp(a t) - 1) / a
double growth(double a, double t) { return a == 0.0 ? t : std::expm1(a * t) / a; }

/// Bisection with Newton steps inside: y(low) <= 0 < y(high), y increasing between.
template <class Value, class Slope>
double increasing_zero(const Value& y, const Slope& slope, double low, double high) {
  double t = high;
  for (int i = 0; i < 200; ++i) {
    const double value = y(t);
    (value > 0.0 ? high : low) = t;
    double next = t - value / slope(t);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == t || !(next > low && next < high)) break;
    if (std::abs(next - t) <= 2e-16 * t) break;
    t = next;
  }
  return high;  // NOTE: on the far side, so that the event has happened
}

}  // namespace

double StripMotion::position(double t) const { return x0 + v0 * growth(rate, t); }

double StripMotion::integrated_excursion(double t) const {
  const double z = rate * t;
  // NOTE: the difference loses digits where z is small: 1e-4 leaves twelve, and there three terms are exact.
  const double factor =
      std::abs(z) < 1e-4 ? 0.5 * t * t * (1.0 + z / 3.0 * (1.0 + z / 4.0)) : (growth(rate, t) - t) / rate;
  return v0 * factor;
}

std::optional<double> StripMotion::time_to(double target) const {
  const double way = (target - x0) / v0;
  if (!(way >= 0.0)) return std::nullopt;
  if (rate == 0.0) return way;
  if (!(rate * way > -1.0)) return std::nullopt;
  return std::log1p(rate * way) / rate;
}

std::optional<double> time_of_return(const StripMotion& motion, const SaturatedMotion& saturated, double end,
                                     double x_end) {
  const auto y = [&](double t) {
    return saturated.distance + saturated.velocity * t + saturated.slope * motion.integrated_excursion(t);
  };
  const auto slope = [&](double t) { return saturated.velocity + saturated.slope * (motion.position(t) - motion.x0); };
  const double first = saturated.velocity;
  const double last = saturated.velocity + saturated.slope * (x_end - motion.x0);
  if (first <= 0.0 && last <= 0.0) return std::nullopt;
  std::optional<double> turn;
  if (first * last < 0.0) turn = motion.time_to(motion.x0 - saturated.velocity / saturated.slope);
  const double low = first > 0.0 || !turn ? 0.0 : *turn;  // y increases from here
  double high = first > 0.0 && turn ? *turn : end;        // to here
  if (std::isinf(high)) {
    high = low > 0.0 ? 2.0 * low : 1.0;
    while (!(y(high) > 0.0)) {
      if (high > 1e100) return std::nullopt;
      high *= 2.0;
    }
  }
  if (!(y(high) > 0.0)) return std::nullopt;
  return increasing_zero(y, slope, low, high);
}

}  // namespace saltus::switching
