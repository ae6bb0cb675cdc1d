#include "saltus/event_integrator/approach/nested_zero_approach.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"
#include "saltus/event_integrator/search/cells.hpp"

namespace saltus::event_integrator {

/// The functions of the mode that this may happen to.
bool NestedZeroApproach::begin_mode() {
  const bool any = watches();
  functions_.clear();
  since_ = here_.t;
  for (const int j : here_.state.sliding) {
    for (const int i : kernel_.inner(j)) {
      if (here_.state.mode[at(i)] == 0 || !kernel_.has_root_inside(j, i)) continue;
      const auto is_it = [i](const Approaching& other) { return other.function == i; };
      auto place = std::find_if(functions_.begin(), functions_.end(), is_it);
      if (place == functions_.end()) place = functions_.insert(place, Approaching{i, {}});
      place->around.push_back(j);
    }
  }
  return any;
}

void NestedZeroApproach::accepted(double h) {
  if (!watches()) return;
  last_slope_ = here_.slope;
  last_step_ = h;
}

void NestedZeroApproach::find_values() {
  values_.resize(at(kernel_.event_functions()));
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), values_.data());
}

/// Errors of g move the time that is left, p |g / g'|, in proportion: with g as accurate as a state of its size may be,
/// those of the last steps add to rtol like a geometric series.
void NestedZeroApproach::limit(ode::Tolerances& parts) {
  if (!watches()) return;
  find_values();
  auto& [rtol, atol] = parts;
  // Where g is a difference of states, its rounding moves the selection by a part of u / g. The selection is of the
  // size of |g'|^2 / g. Less than this could not be reached any more before g is as small as it may get.
  constexpr double part = 1e-12;
  const double smallest = part / tolerances_.mode().rtol;
  for (const Approaching& approaching : functions_) {
    const Rate rate = rates_.here(approaching.function);
    const double wanted = tolerances_.mode().rtol * std::abs(values_[at(approaching.function)]);
    if (!(wanted > 0.0)) continue;
    atol = std::min(atol, wanted / (rate.slope * tolerances_.mode().atol));
    rtol = std::min(rtol, std::max(smallest, wanted / (rate.magnitude * tolerances_.mode().rtol)));
  }
}

/// When g is 0, once that is known far better than the tolerance asks for and little is left until then: g goes like
/// (T - t)^p, so that |g / g'| = (T - t)/p, less what is of higher order in T - t. p follows from where it has halved;
/// that T is right from the one that the halving before has given.
std::optional<double> NestedZeroApproach::end_of(Approaching& approaching) {
  constexpr double little = 1e-3;  // of the time since the mode began: exits and other events are looked for until then
  constexpr double agree = 0.1;    // of the tolerance of a step, over that time; the error itself is a third of it
  constexpr double bent = 1.02;    // of zeros that are crossed p is 1, to `little`
  const double g = values_[at(approaching.function)];
  const Rate rate = rates_.here(approaching.function);
  const double ratio = g == 0.0 ? 0.0 : -g / rate.value;
  const double since = here_.t - since_;
  const double resolved = 16.0 * here_.smallest_step();
  const Approaching last = approaching;
  const double power = (here_.t - last.t) / (last.ratio - ratio);
  const double left = power * ratio;
  const bool turns = !(ratio >= 0.0) || ratio > last.ratio || !std::isfinite(last.ratio);
  const bool halved = !turns && ratio <= 0.5 * last.ratio;
  if (turns || halved) {
    approaching.t = here_.t;
    approaching.ratio = ratio;
    approaching.end = turns ? std::numeric_limits<double>::quiet_NaN() : here_.t + left;
  }
  if (turns || !(power > bent)) return std::nullopt;
  const bool agrees =
      std::abs(here_.t + left - last.end) <= std::max(agree * tolerances_.mode().rtol * since, 0.25 * resolved);
  const bool rounds = std::abs(g) <= 1e5 * rounding_of(rate.magnitude);  // five digits of g are left
  if (left <= resolved || (halved && left <= little * since && (agrees || rounds))) return here_.t + left;
  return std::nullopt;
}

/// The point where these of functions_ are 0: by a parabola through the last two slopes, then onto the set. nullopt
/// where states that the set does not fix bend too much for that, or something else happens before.
std::optional<Located> NestedZeroApproach::at_zeros(double end, const std::vector<std::size_t>& reached) {
  const double left = end - here_.t;
  Located located{end, here_.x, {}, {}};
  std::vector<HeldFunction> held;
  std::vector<double> alpha = here_.state.alpha;
  const auto hold = [&](int j) {
    const auto is_it = [j](const HeldFunction& function) { return function.surface == j; };
    if (std::any_of(held.begin(), held.end(), is_it)) return;
    held.push_back({j, 0});
    alpha[at(j)] = 0.5;
  };
  for (const std::size_t k : reached) {
    hold(functions_[k].function);
    for (const int j : functions_[k].around) hold(j);
    const auto& functions = search_.functions();
    const auto is_it = [&](const EventFunction& function) {
      return function.kind == FunctionKind::surface && function.index == functions_[k].function;
    };
    const auto place = std::find_if(functions.begin(), functions.end(), is_it);
    if (place == functions.end()) return std::nullopt;
    located.functions.push_back(static_cast<std::size_t>(place - functions.begin()));
    located.signs.push_back(place->sign);
  }
  HeldFunctions set(kernel_);
  set.set(held, alpha);
  set.differentiate(here_.t, here_.x.data());
  std::size_t on_set = 0;
  for (linalg::Index i = 0; i < set.rows().cols(); ++i) on_set += set.rows().col(i).is_zero() ? 0U : 1U;
  const bool fixed = on_set <= held.size();
  for (std::size_t i = 0; i < here_.x.size(); ++i) {
    const double bend = 0.5 * left * (here_.slope[i] - last_slope_[i]) * std::min(1.0, left / last_step_);
    located.x[i] += left * here_.slope[i] + bend;
    const bool is_fixed = fixed && !set.rows().col(static_cast<linalg::Index>(i)).is_zero();
    const double tolerance = tolerances_.mode().atol + tolerances_.mode().rtol * std::abs(here_.x[i]);
    if (!is_fixed && left > 16.0 * here_.smallest_step() && !(std::abs(bend) <= tolerance)) return std::nullopt;
  }
  static_cast<void>(set.project(end, located.x.data()));
  if (!is_finite(located.x)) return std::nullopt;
  const std::vector<double> before = zeros_.functions(here_.t, here_.x.data());
  const auto& after = zeros_.functions(end, located.x.data());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool is_it = contains(located.functions, i);
    const auto kind = search_.functions()[i].kind;
    const bool has_value = kind == FunctionKind::surface || kind == FunctionKind::user || is_cell_end(kind);
    if (!is_it && has_value && before[i] * after[i] < 0.0) return std::nullopt;
  }
  return located;
}

/// Where functions that the motion runs into the zeros of get there, together with those that do within their accuracy.
std::optional<Located> NestedZeroApproach::ahead(double until) {
  find_values();
  std::optional<double> first;
  for (Approaching& approaching : functions_) {
    const auto end = end_of(approaching);
    if (end && (!first || *end < *first)) first = end;
  }
  if (!first || *first >= until) return std::nullopt;
  std::vector<std::size_t> reached;
  const double together = std::max(tolerances_.mode().rtol * (*first - since_), 16.0 * here_.smallest_step());
  for (std::size_t k = 0; k < functions_.size(); ++k) {
    if (std::abs(functions_[k].end - *first) <= together) reached.push_back(k);
  }
  return at_zeros(*first, reached);
}

}  // namespace saltus::event_integrator
