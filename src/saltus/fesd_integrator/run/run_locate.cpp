// Where a switch is: the common length of the elements before it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

std::optional<double> Run::locate(int count, double guess, const Violation& violation, double longest, TimeWarp warp) {
  // Secant steps from the root of the interpolant, inside the bracket (lower: the condition holds; upper: it does not).
  double lower = 0.0, upper = std::numeric_limits<double>::infinity();
  double h = guess, h_before = 0.0, value_before = 0.0;
  double slope = violation.slope * count;  // of the value over the common length
  int polished = 0;                        // steps taken from values within their roundings
  constexpr int most_iterations = 60, most_polishing_steps = 3;
  for (int i = 0; i < most_iterations; ++i) {
    // The other conditions are looked at afterwards.
    Violation other;
    Point left{t_, x_, selections_, size_};
    bool failed = false;
    auto selections = selections_;
    for (int k = 0; k < count; ++k) {
      auto& element = chain_.elements[at(k)];
      const Element* last = k > 0 ? &chain_.elements[at(k - 1)] : previous_ ? &*previous_ : nullptr;
      element.warp = {k == 0 ? warp.left : 1, k + 1 == count ? warp.right : 1};
      const bool continues = last != nullptr && last->warp.is_none() && element.warp.is_none();
      const bool warm = i > 0 || continues;  // i > 0: stage values of the last try
      if (i == 0 && continues) solver_.extrapolate(*last, h, element);
      auto outcome = solver_.solve(left, h, {&set_, 1}, held_.data(),
                                   warm ? ElementSolver::Guess::stages : ElementSolver::Guess::left_end, element);
      if (outcome != ElementSolver::Outcome::solved) {
        outcome = solver_.solve(left, h, {&set_, 1}, held_.data(), ElementSolver::Guess::left_end, element);
      }
      failed = outcome != ElementSolver::Outcome::solved ||
               watch_.look(element, set_, held_.data(), selections, other) == Watch::Answer::not_finite;
      if (failed) break;
      left = {t_ + (k + 1) * h, element.end, selections, element.size};
    }
    if (failed) return std::nullopt;
    const double value = watch_.end_value(set_, violation.condition), noise = watch_.noise(violation.condition);
    if (!std::isfinite(value)) return std::nullopt;
    if (upper - lower <= 4.0 * rounding_unit * h) return h;
    if (std::abs(value) <= 0.25 * noise) {
      // Roundings of components much smaller than the largest are smaller than this noise, and divided by a small slope
      // it is a time.
      const bool resolved = std::abs(value) * count <= 2.0 * rounding_unit * (t_ + count * h) * std::abs(slope);
      const bool stalls = polished > 0 && std::abs(value) > 0.5 * std::abs(value_before) && value * value_before > 0.0;
      if (resolved || stalls || polished == most_polishing_steps) return h;
      ++polished;
    }
    (value > 0.0 ? lower : upper) = h;
    if (i > 0 && h != h_before && value != value_before) slope = (value - value_before) / (h - h_before);
    h_before = h;
    value_before = value;
    double next = slope < 0.0 ? h - value / slope : std::numeric_limits<double>::quiet_NaN();
    const double inside_lower = lower, inside_upper = std::isfinite(upper) ? upper : std::min(2.0 * h, longest);
    if (!(next > inside_lower && next < inside_upper)) {
      if (!std::isfinite(upper) && h >= longest) return std::nullopt;  // it never ends
      next = std::isfinite(upper) ? 0.5 * (lower + upper) : inside_upper;
    }
    if (next == h) return h;
    if (std::abs(value) <= noise && i > 8) return h;
    h = next;
  }
  return std::nullopt;
}

bool Run::fits_bounds(int elements, double remaining, double tau, int& count) const {
  constexpr double roundings = 1e-12;
  const double low = (1.0 - options_.step_bounds - roundings) * mean_;
  const double high = (1.0 + options_.step_bounds + roundings) * mean_;
  const auto fits = [&](int before) {
    const double h = tau / before, behind = (remaining - tau) / (elements - before);
    return low <= h && h <= high && low <= behind && behind <= high;
  };
  const int nearest = count;
  for (int away = 0; away < elements; ++away) {
    for (const int candidate : {nearest + away, nearest - away}) {
      if (candidate < 1 || candidate >= elements || !fits(candidate)) continue;
      count = candidate;
      return true;
    }
  }
  return false;
}

std::optional<Run::Located> Run::find_switch(int elements, double remaining, Violation violation, std::size_t element) {
  double tau = chain_.elements[element].h * (static_cast<double>(element) + violation.theta);
  // Each round goes to a condition that ends earlier than the one before.
  const std::size_t rounds = set_.conditions().size() + 2;
  for (std::size_t round = 0; round < rounds; ++round) {
    int count = std::clamp(static_cast<int>(std::lround(elements * tau / remaining)), 1, elements - 1);
    const bool divides = !fits_bounds(elements, remaining, tau, count);
    if (divides) count = elements;
    const TimeWarp warp{previous_ ? 1 : warp_behind(tau), warp_before(chain_.elements[element])};
    const auto h = locate(count, tau / count, violation, remaining / count, warp);
    if (!h) return std::nullopt;
    // The elements as they are now, all conditions: does another end before?
    Violation other;
    auto selections = selections_;
    bool earlier = false, coarse = false;
    share_ = 0.0;
    chain_.left[0] = selections;
    for (int k = 0; k < count && !earlier; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const auto answer = watch_.look(chain_.elements[index], set_, held_.data(), selections, other);
      chain_.left[index + 1] = selections;
      chain_.errors[index] = watch_.errors();
      coarse = too_coarse(chain_.elements[index], watch_.errors());
      if (answer == Watch::Answer::not_finite) return std::nullopt;
      if (answer != Watch::Answer::violated) continue;
      const double at = *h * (k + other.theta);
      const bool same = other.condition.kind == violation.condition.kind &&
                        other.condition.selection == violation.condition.selection;
      if (at >= *h * count * (1.0 - 1e-12)) continue;  // at the same time
      if (same && k + 1 == count && other.theta > 1.0 - 1e-9) continue;
      earlier = true;
      element = index;
      tau = at;
      violation = other;
    }
    if (!earlier) {
      chain_.count = static_cast<std::size_t>(count);
      return Located{count, *h, violation.condition, coarse, divides};
    }
    if (tau <= 0.0) return Located{0, 0.0, violation.condition};
  }
  return std::nullopt;
}

}  // namespace saltus::fesd_integrator
