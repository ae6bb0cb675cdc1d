// The event search where a step is a Taylor series: affine functions are polynomials of its degree.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

/// Needs no samples: the polynomial is cut where the search does.
EventSearch::Finding EventSearch::find_in_series(const ode::DenseStep& step, double from, double to,
                                                 std::size_t i) const {
  const auto& function = mode_.functions[i];
  auto along = mode_.forms.along_series(i, step);
  along.subtract(function.offset);
  const auto is_number = [](double b) { return std::isfinite(b); };
  if (!std::all_of(along.coefficients.begin(), along.coefficients.end(), is_number)) {
    return not_finite(function, along.coefficients.front());
  }
  const bool whole = from == 0.0 && to == 1.0;
  const auto coefficients = whole ? along.coefficients : ode::part_of(along.coefficients, from, to);
  // The function's own roundings, and those of its polynomial.
  const double noise = std::max(levels_.noise[i], along.rounding);
  const int sign = function.sign != 0 ? function.sign : sign_behind_zero(coefficients, noise);
  if (sign == 0) return {};
  const int zero_order = from == 0.0 ? function.zero_order : 0;
  const auto change = whole ? ode::first_sign_change(coefficients, along.terms, sign, zero_order, noise)
                            : ode::first_sign_change(coefficients, sign, zero_order, noise);
  if (!change) return {};
  const double theta = from + (to - from) * 0.5 * (change->lower + change->upper);
  return {true, Hit{i, theta, along.derivative(theta) / step.h, sign}};
}

}  // namespace saltus::event_integrator
