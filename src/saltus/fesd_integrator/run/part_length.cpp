#include <algorithm>
#include <cmath>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/part_length_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Parts of simulation steps that are divided for their errors are not shorter than this: what then is left of them has
/// no derivatives, or is the singularity of a solution.
constexpr double shortest_for_errors = 1e-3;
/// Between switches of cycles that shrink, where the surface has roots: what is lost there is lost in every cycle.
constexpr int elements_per_switch = 16;

}  // namespace

double PartLength::end_of_part(double t, double end, double last_switch) {
  const double remaining = end - t;
  double longest = longest_;
  if (between_switches_ > 0.0) {
    // Where the next switch does not come, cycles have ended.
    if (t - last_switch > between_switches_ * elements_per_switch) between_switches_ = 0.0;
    if (between_switches_ > 0.0) longest = std::min(longest, between_switches_);
  }
  if (!(longest < shape_.nominal) || remaining <= longest) return end;
  return t + remaining / std::ceil(remaining / longest * (1.0 - 1e-12));
}

bool PartLength::is_too_coarse(double h, double share) {
  share_ = std::max(share_, share);
  // Twice: parts of the shortest length are so but for the roundings of t.
  return share_ > 1.0 && h * shape_.elements > 2.0 * shortest_for_errors * shape_.nominal;
}

/// Shares grow with h^n_s; 0.8 and the bounds are those of step controls [hairer1993].
double PartLength::ratio() const { return 0.8 * std::pow(share_, -1.0 / shape_.stages); }

void PartLength::shorten_behind(double h) {
  if (shape_.errors == Shape::Errors::ignored) return;
  longest_ = std::max(h * shape_.elements * std::clamp(ratio(), 0.1, 0.5), shortest_for_errors * shape_.nominal);
}

void PartLength::lengthen_behind(double h) {
  if (shape_.errors == Shape::Errors::ignored) return;
  longest_ = std::max(longest_, h * shape_.elements * std::min(ratio(), 4.0));
}

void PartLength::follow(const CycleSeries& series, double t) {
  const auto next = series.next_switch();
  between_switches_ = next ? *next * shape_.elements / elements_per_switch : 0.0;
  // Cycles this short are those of roundings, and elements at the roundings of t would get nowhere.
  constexpr double shortest_followed = 1e-10, roundings = 64.0 * rounding_unit;
  if (between_switches_ <= std::max(shortest_followed * shape_.nominal, shape_.elements * roundings * std::abs(t))) {
    between_switches_ = 0.0;
  }
}

}  // namespace saltus::fesd_integrator
