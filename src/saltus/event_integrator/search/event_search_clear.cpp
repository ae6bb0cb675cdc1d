// Sign changes that may be errors of their step: which of them count. Those of [[events]] count where they are more.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"
#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {

bool EventSearch::is_within_errors(int function, double value, double t, const double* x) {
  return kernel_.is_listed_only(function) &&
         std::abs(value) <= errors_.of(function, t, x, mode_.state.alpha.data(), {t, t, x, x});
}

/// Whether a function passes its zero by no more than errors of the step may.
bool EventSearch::may_be_an_error(const ode::DenseStep& step, const Hit& hit) const {
  constexpr double by_far = 1e3;
  return std::abs(hit.slope) * step.h <= by_far * levels_.accuracy[hit.function];
}

/// Whether a zero of a surface or a guard is more than errors of the step by far, or the field leads through it. A step
/// that is too long for what decays ends beyond zero, where the field would not have gone. A surface that is left at
/// the start of the step does not decay to it: cycles of one step each are not asked.
bool EventSearch::is_confirmed(const ode::DenseStep& step, const Hit& hit) {
  const auto& function = mode_.functions[hit.function];
  const bool is_surface = function.kind == FunctionKind::surface && function.zero_order == 0;
  const bool is_guard = function.kind == FunctionKind::user && !is_listed_only(hit.function);
  if (!(is_surface || is_guard) || !may_be_an_error(step, hit)) return true;
  const double t = step.t + hit.theta * step.h;
  step.evaluate(hit.theta, x_.data());
  std::vector<double> slope(x_.size());
  evaluation::AffineRow gradient;
  field_(t, x_.data(), slope.data());
  const Rate rate = rate_along(kernel_, function.index, t, x_, mode_.state.alpha, slope, gradient);
  constexpr double turned = 1e-3;
  return hit.sign * rate.value < turned * hit.sign * hit.slope;
}

/// Whether a zero of a user function or a kink is one of its roundings, as the surfaces that are slid on keep it.
bool EventSearch::is_rounding(const ode::DenseStep& step, const Hit& hit) {
  const auto& function = mode_.functions[hit.function];
  const bool is_kink = function.kind == FunctionKind::surface && kernel_.layout().surfaces[at(function.index)].is_kink;
  const bool holds_nothing = is_kink || function.kind == FunctionKind::user;
  if (!holds_nothing || mode_.state.sliding.empty() || !may_be_an_error(step, hit)) return false;
  step.evaluate(hit.theta, x_.data());
  return is_kept_by_sliding(kernel_, mode_.state, function.index, step.t + hit.theta * step.h, x_.data());
}

/// Coefficients of a function over [from, to] as `find` has them, handed to `take`.
template <class Take>
void EventSearch::take_coefficients(const ode::DenseStep& step, double from, double to, std::size_t i,
                                    Take take) const {
  const double offset = mode_.functions[i].offset;
  const bool whole = from == 0.0 && to == 1.0;
  if (step.is_series() && mode_.forms.has(i)) {
    auto along = mode_.forms.along_series(i, step);
    along.subtract(offset);
    return take(whole ? along.coefficients : ode::part_of(along.coefficients, from, to));
  }
  if (mode_.forms.has(i) && whole) {
    auto along = mode_.forms.along(i, step);
    for (double& b : along) b -= offset;
    return take(along);
  }
  std::array<double, ode::event_nodes> values;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = samples_[k * mode_.functions.size() + i];
  take(ode::to_bernstein(values));
}

/// The first sign change that is more than the errors of the step: behind it the function gets beyond them, before it
/// is beyond them on the first side again. Where the step ends before that its sign is what it was, and a later step
/// tells. All that is left of a state that has decayed is errors of both signs.
EventSearch::Finding EventSearch::find_clear(const ode::DenseStep& step, double from, double to, std::size_t i) {
  Finding finding = find(step, from, to, i);
  if (finding.hit && is_rounding(step, *finding.hit)) return {};
  if (!finding.hit || !is_listed_only(i)) return finding;
  Hit& hit = *finding.hit;
  const auto& function = mode_.functions[i];
  double error = 0.0;
  for (const double theta : {from, hit.theta, to}) {  // (x - 1)^3 has no gradient at its zero
    step.evaluate(theta, x_.data());
    error = std::max(
        error, errors_.of(function.index, step.t + theta * step.h, x_.data(), mode_.state.alpha.data(), range_.bounds));
  }
  take_coefficients(step, from, to, i, [&](const auto& coefficients) {
    const auto change_beyond = [&](double level) {
      return ode::first_sign_change(coefficients, hit.sign, from == 0.0 ? function.zero_order : 0,
                                    std::max(levels_.noise[i], level));
    };
    const auto change = change_beyond(error);
    if (!change) return finding.hit.reset();
    // Of the steps of explicit methods that are too long for what decays some are off by thousands of tolerances.
    constexpr double doubtful = 1e4;
    hit.doubts = change_beyond(doubtful * error) ? 0 : 3;
    // A zero before it is one of a dip into the errors.
    constexpr double bracket = 0x1p-30;
    if (hit.theta >= from + (to - from) * (change->lower - bracket)) return;
    const double local = 0.5 * (change->lower + change->upper);
    hit.theta = from + (to - from) * local;
    hit.slope = ode::derivative(coefficients, local) / ((to - from) * step.h);
  });
  return finding;
}

/// Whether all suspects are curved functions of the kernel that are not at zero where the step starts.
bool EventSearch::are_away_at_start() const {
  return std::all_of(suspects_.begin(), suspects_.end(), [&](std::size_t i) {
    const auto& function = mode_.functions[i];
    return uses_phi(function) && !mode_.forms.has(i) && function.sign != 0 && function.zero_order == 0;
  });
}

/// Whether the samples of the whole step show that a function keeps its sign, whatever its rounding is.
bool EventSearch::clearly_keeps_sign(const ode::DenseStep& step, std::size_t i) {
  std::array<double, ode::event_nodes> values;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = samples_[k * mode_.functions.size() + i];
  const auto coefficients = ode::to_bernstein(values);
  double margin = std::numeric_limits<double>::max(), size = 0.0;
  for (const double b : coefficients) {
    if (!(mode_.functions[i].sign * b > 0.0)) return false;
    margin = std::min(margin, std::abs(b));
    size = std::max(size, std::abs(b));
  }
  const double wanted = std::max(0.125 * margin, 0.1 * errors_.of_run().rtol * size);
  return chebyshev_tail(values) <= wanted && !misses(step, 0.0, 1.0, i, coefficients, wanted);
}

}  // namespace saltus::event_integrator
