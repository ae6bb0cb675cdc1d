#include <algorithm>
#include <cmath>

#include "saltus/fesd_integrator/run/safeguarded_secant_internal.hpp"
#include "saltus/fesd_integrator/run/switch_locator_internal.hpp"

namespace saltus::fesd_integrator {

std::optional<int> PartDivision::elements_before(double tau, int count) const {
  constexpr double roundings = 1e-12;
  const double low = (1.0 - bounds - roundings) * mean;
  const double high = (1.0 + bounds + roundings) * mean;
  const auto fits = [&](int before) {
    const double h = tau / before, behind = (remaining - tau) / (elements - before);
    return low <= h && h <= high && low <= behind && behind <= high;
  };
  for (int away = 0; away < elements; ++away) {
    for (const int candidate : {count + away, count - away}) {
      if (candidate >= 1 && candidate < elements && fits(candidate)) return candidate;
    }
  }
  return std::nullopt;
}

std::optional<double> SwitchLocator::locate(const Search& search, const Violation& violation) {
  SafeguardedSecant secant({search.guess, violation.slope * search.count, search.longest, position_.t(), search.count});
  for (;;) {
    // The other conditions are looked at afterwards.
    const auto which = secant.is_first() ? Chain::Try::first : Chain::Try::again;
    if (!chain_.solve_to_end(search.count, secant.h(), search.warp, which)) return std::nullopt;
    const double value = context_.watch.end_value(position_.set(), violation.condition);
    switch (secant.take(value, context_.watch.noise(violation.condition))) {
      case SafeguardedSecant::State::found:
        return secant.h();
      case SafeguardedSecant::State::none:
        return std::nullopt;
      case SafeguardedSecant::State::searching:
        break;
    }
  }
}

SwitchLocator::Check SwitchLocator::check(int count, double h, const Violation& violation) {
  Check found;
  length_.begin_chain();
  chain_.look_again(count, [&](std::size_t k, Watch::Answer answer, const Violation& other) {
    found.coarse = chain_.is_too_coarse(chain_.element(k), chain_.errors(k));
    if (answer == Watch::Answer::not_finite) found.answer = Check::Answer::not_finite;
    if (answer != Watch::Answer::violated) return answer == Watch::Answer::holds;
    const auto i = static_cast<int>(k);
    const double at = h * (i + other.theta);
    const bool same =
        other.condition.kind == violation.condition.kind && other.condition.selection == violation.condition.selection;
    if (at >= h * count * (1.0 - 1e-12)) return true;  // at the same time
    if (same && i + 1 == count && other.theta > 1.0 - 1e-9) return true;
    found.answer = Check::Answer::ends_earlier;
    found.tau = at;
    found.element = k;
    found.violation = other;
    return false;
  });
  return found;
}

std::optional<Located> SwitchLocator::find(int elements, double remaining, Violation violation) {
  std::size_t element = chain_.count() - 1;
  double tau = chain_.element(element).h * (static_cast<double>(element) + violation.theta);
  const PartDivision division{elements, remaining, length_.mean(), context_.options.step_bounds};
  // Each round goes to a condition that ends earlier than the one before.
  const std::size_t rounds = position_.set().conditions().size() + 2;
  for (std::size_t round = 0; round < rounds; ++round) {
    const int nearest = std::clamp(static_cast<int>(std::lround(elements * tau / remaining)), 1, elements - 1);
    const auto fitting = division.elements_before(tau, nearest);
    const int count = fitting.value_or(elements);
    const TimeWarp warp{chain_.warp_here(tau), chain_.warps().before(chain_.element(element))};
    const auto h = locate({count, tau / count, remaining / count, warp}, violation);
    if (!h) return std::nullopt;
    const Check earlier = check(count, *h, violation);
    if (earlier.answer == Check::Answer::not_finite) return std::nullopt;
    if (earlier.answer == Check::Answer::all_hold) {
      chain_.set_count(static_cast<std::size_t>(count));
      return Located{count, *h, violation.condition, earlier.coarse, !fitting};
    }
    element = earlier.element;
    tau = earlier.tau;
    violation = earlier.violation;
    if (tau <= 0.0) return Located{0, 0.0, violation.condition};
  }
  return std::nullopt;
}

}  // namespace saltus::fesd_integrator
