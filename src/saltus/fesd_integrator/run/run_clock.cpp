// Rows at values of a clock, which never goes back.
#include <algorithm>
#include <cmath>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

void Run::emit_clock_times(const Element& element, const std::vector<double>& selections, double until) {
  const auto clock_at = [&](double theta) {
    event_state(element, selections, theta);
    return between_x_[*options_.clock];
  };
  const double last = (until - element.t) / element.h, end = clock_at(last);
  for (; next_time_ < options_.times.size() && options_.times[next_time_] < end; ++next_time_) {
    const double time = options_.times[next_time_], rounding = 4.0 * rounding_unit * std::max(1.0, std::abs(time));
    double low = 0.0, high = last, below = clock_at(low) - time, above = end - time, theta = low, value = below;
    constexpr int most_steps = 100;
    for (int i = 0; i < most_steps && std::abs(value) > rounding && high > low; ++i) {
      // The secant where it divides well, else the middle.
      const double secant = low - below * (high - low) / (above - below);
      theta = i % 3 == 2 || !(secant > low && secant < high) ? 0.5 * (low + high) : secant;
      value = clock_at(theta) - time;
      (value < 0.0 ? low : high) = theta;
      (value < 0.0 ? below : above) = value;
    }
    recorder_.row(element.t + theta * element.h, between_x_, set_, between_selections_, held_.data());
  }
}

}  // namespace saltus::fesd_integrator
