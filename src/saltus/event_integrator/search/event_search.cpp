#include "saltus/event_integrator/search/event_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/search/cells.hpp"
#include "saltus/event_integrator/search/event_search_internal.hpp"

namespace saltus::event_integrator {
namespace {

constexpr int deepest = 10;  // a step is cut into at most 2^10 pieces before it is shortened instead

/// cos(pi degree (n - k) / n) of the last two degrees.
const std::array<std::array<double, ode::event_nodes>, 2>& tail_cosines() {
  static const auto table = [] {
    constexpr int n = ode::event_degree;
    std::array<std::array<double, ode::event_nodes>, 2> cosines{};
    for (int k = 0; k <= n; ++k) {
      for (int last = 0; last < 2; ++last) {
        cosines[at(last)][at(k)] = std::cos(std::numbers::pi * (n - 1 + last) * (n - k) / n);
      }
    }
    return cosines;
  }();
  return table;
}

/// Three places that are not symmetric to each other: a periodic function does not fool the nodes and these as well.
constexpr std::array<std::size_t, 3> checked_places{0, 3, 6};

/// What each Bernstein coefficient contributes there.
const std::array<ode::BernsteinCoefficients, checked_places.size()>& weights_at_checks() {
  static const auto table = [] {
    std::array<ode::BernsteinCoefficients, checked_places.size()> weights{};
    for (std::size_t place = 0; place < weights.size(); ++place) {
      for (std::size_t i = 0; i < ode::event_nodes; ++i) {
        ode::BernsteinCoefficients unit{};
        unit[i] = 1.0;
        weights[place][i] = ode::evaluate(unit, ode::check_nodes()[checked_places[place]]);
      }
    }
    return weights;
  }();
  return table;
}

/// Whether an interpolant that misses its function by `error` or so shows one passage through zero all the same: but
/// for a band around zero, eight times as wide, the function is on one side before it and on the other one behind it.
/// The place is then as good as the band is narrow, and location goes on from the retaken step: an error of a
/// thousandth costs it one more step, cutting the interval in two eighteen evaluations and more.
bool passes_once(const ode::BernsteinCoefficients& coefficients, int sign, double error, double size) {
  constexpr double worth_a_step = 1e-3;
  if (!(error <= worth_a_step * size)) return false;
  ode::BernsteinCoefficients turned = coefficients;
  for (double& b : turned) b *= sign;
  return ode::falls_once(turned, 8.0 * error);
}

/// Whether a smooth function with these values at the five Chebyshev-Lobatto nodes of an interval keeps its sign by a
/// wide margin: the sum of the Chebyshev coefficients bounds the interpolant, the last two say how much it may miss.
bool stays_far(const std::array<double, 5>& v, int sign) {
  const double r = std::numbers::sqrt2 / 2.0;
  const double c0 = (0.5 * (v[0] + v[4]) + v[1] + v[2] + v[3]) / 4.0;
  const double c1 = (0.5 * (v[4] - v[0]) + r * (v[3] - v[1])) / 2.0;
  const double c2 = (0.5 * (v[0] + v[4]) - v[2]) / 2.0;
  const double c3 = (0.5 * (v[4] - v[0]) - r * (v[3] - v[1])) / 2.0;
  const double c4 = (0.5 * (v[0] + v[4]) - v[1] + v[2] - v[3]) / 4.0;
  const double tail = std::abs(c3) + std::abs(c4);
  return sign * c0 > std::abs(c1) + std::abs(c2) + 8.0 * tail;
}

}  // namespace

double chebyshev_tail(const std::array<double, ode::event_nodes>& values) {
  constexpr int n = ode::event_degree;
  double tail = 0.0;
  for (const int degree : {n - 1, n}) {
    double sum = 0.0;
    for (int k = 0; k <= n; ++k) {
      const double weight = (k == 0 || k == n) ? 0.5 : 1.0;
      sum += weight * values[at(k)] * tail_cosines()[at(degree - n + 1)][at(k)];
    }
    tail += std::abs(sum) * (degree == n ? 1.0 : 2.0) / n;
  }
  return tail;
}

/// The argument of a cell may be undefined where a branch that is not taken holds it; a step that looks beyond the end
/// of its region may find it defined there.
EventSearch::Finding EventSearch::not_finite(const EventFunction& function, double at_start) {
  return {is_cell_end(function.kind) && !std::isfinite(at_start), {}};
}

EventSearch::EventSearch(const evaluation::ModelKernel& kernel, ModeField& field, Ledger& ledger, ode::Method method,
                         const ode::Tolerances& tolerances)
    : kernel_(kernel),
      field_(field),
      five_nodes_suffice_(ode::dense_degree(method) <= 4),
      errors_(kernel, tolerances),
      mode_(at(kernel.states())),
      ledger_(ledger) {
  for (int j = 0; j < kernel.event_functions(); ++j) nesting_.push_back(!kernel.inner(j).empty());
  any_nesting_ = contains(nesting_, true);
  const auto n_phi = at(kernel.event_functions());
  for (auto* vector : {&values_.phi, &values_.magnitude, &values_.slope, &values_.middle, &values_.radius})
    vector->resize(n_phi);
  values_.radii.resize(1 + at(kernel.states()));
  x_.resize(at(kernel.states()));
  range_.resize(at(kernel.states()));
  mode_.kept_states.resize(at(kernel.switching_functions()));
  turned_.beside.resize(mode_.kept_states.size());
  entered_.assign(at(kernel.cells()), -1);
}

void EventSearch::find_pressure(double t, const double* x) {
  if (held_.guards.empty()) return;
  kernel_.hold_pressure(t, x, field_.alpha().data(), values_.pressure.data());
}

/// Rounding and tolerance levels of some functions for the step that starts at (t, x).
void EventSearch::rescale(double t, const double* x, const std::vector<std::size_t>& which,
                          const FunctionParts& parts) {
  if (parts.phi || parts.nested)
    kernel_.scales(t, x, mode_.state.alpha.data(), values_.magnitude.data(), values_.slope.data());
  if (parts.exits) field_.exits(t, x, mode_.exits.data());
  if (parts.pressure) find_pressure(t, x);
  for (const std::size_t i : which) set_noise(i, x);
}

void EventSearch::set_noise(std::size_t i, const double* x) {
  const auto& function = mode_.functions[i];
  if (uses_phi(function)) {
    const bool by_form = mode_.is_threshold(i);
    const auto j = at(function.index);
    const double magnitude = by_form ? std::abs(mode_.forms.factor(i) * x[mode_.forms.state(i)]) : values_.magnitude[j];
    const double slope = by_form ? std::abs(mode_.forms.factor(i)) : values_.slope[j];
    // A handful of roundings of terms as large as the magnitude.
    levels_.set(i, rounding_of(magnitude), 0.1 * (errors_.of_run().atol * slope + errors_.of_run().rtol * magnitude));
    return;
  }
  if (function.kind == FunctionKind::release) {
    const double size = std::abs(values_.pressure[at(function.row)]);
    levels_.set(i, 32.0 * rounding_unit * size, 0.1 * errors_.of_run().rtol * size);
    return;
  }
  const auto& exit = mode_.exits[at(function.row)];
  const bool coupled = field_.solve() == SlidingSolve::coupled;
  const bool is_side = function.is_side();
  // Loss and stability of coupled surfaces are relative to their terms.
  const double size = is_side ? std::abs(exit.below) + std::abs(exit.above) : coupled ? 1.0 : std::abs(exit.loss);
  double noise = 32.0 * rounding_unit * size;
  // Near a two-fold point both fields vanish, but not the terms they are the sum of.
  const bool by_sides = coupled || field_.solve() == SlidingSolve::higher_order;
  if (field_.solve() == SlidingSolve::decoupled || (by_sides && is_side)) {
    noise = std::max(noise, rounding_of(field_.normal_terms(at(function.row))));
  }
  if (mode_.forms.has(i)) {
    noise = std::max(noise, rounding_of(mode_.forms.terms(i, {mode_.start, mode_.start, x, x})));
  }
  levels_.set(i, noise, 0.1 * errors_.of_run().rtol * size);
}

void EventSearch::evaluate_parts(double t, const double* x, const FunctionParts& parts) {
  if (parts.phi) kernel_.functions(t, x, mode_.state.alpha.data(), values_.phi.data());
  if (parts.nested) {
    for (auto& corner : values_.corners) kernel_.functions(t, x, corner.alpha.data(), corner.phi.data());
  }
  if (parts.exits) field_.exits(t, x, mode_.exits.data());
  if (parts.pressure) find_pressure(t, x);
}

/// Value of function i at the point that evaluate_parts was last called with.
double EventSearch::value(std::size_t i, const double* x) const {
  const auto& function = mode_.functions[i];
  if (mode_.is_threshold(i)) return mode_.forms.threshold_value(i, x) - function.offset;
  switch (function.kind) {
    case FunctionKind::surface:
    case FunctionKind::user:
    case FunctionKind::cell_upper:
    case FunctionKind::cell_lower:
      return values_.phi[at(function.index)] - function.offset;
    case FunctionKind::nested:
      return values_.corners[at(function.row)].phi[at(function.index)] - function.offset;
    case FunctionKind::exit_below:
      return mode_.exits[at(function.row)].below - function.offset;
    case FunctionKind::exit_above:
      return mode_.exits[at(function.row)].above - function.offset;
    case FunctionKind::loss:
      return mode_.exits[at(function.row)].loss - function.offset;
    case FunctionKind::instability:
      return mode_.exits[at(function.row)].stability - function.offset;
    case FunctionKind::release:
      return values_.pressure[at(function.row)] - function.offset;
    case FunctionKind::absent:
      return 1.0;  // away from zero
  }
  __builtin_unreachable();
}

void EventSearch::evaluate(double t, const double* x, const std::vector<std::size_t>& which,
                           std::vector<double>& values) {
  values.resize(which.size());
  std::size_t known = 0;
  for (; known < which.size() && mode_.is_threshold(which[known]); ++known) {  // at the usual event all of them
    values[known] = mode_.forms.threshold_value(which[known], x) - mode_.functions[which[known]].offset;
  }
  if (known == which.size()) return;
  evaluate_parts(t, x, mode_.parts_of(which));
  for (std::size_t k = known; k < which.size(); ++k) values[k] = value(which[k], x);
}

/// Samples of some functions at nodes of [from, to].
void EventSearch::sample(const ode::DenseStep& step, double from, double to, const std::vector<std::size_t>& which,
                         Nodes nodes) {
  for (auto& checks : checks_) checks.clear();
  for (std::size_t node = nodes.first; node < ode::event_nodes; node += nodes.stride) {
    const double theta = node_theta(from, to, node);
    const double t = step.t + theta * step.h;
    step.evaluate(theta, x_.data());
    evaluate_parts(t, x_.data(), mode_.curved_parts);
    double* samples = samples_.data() + node * mode_.functions.size();
    for (const std::size_t i : which) {
      samples[i] =
          mode_.forms.has(i) ? mode_.forms.value(i, t, x_.data()) - mode_.functions[i].offset : value(i, x_.data());
    }
  }
}

double EventSearch::node_theta(double from, double to, std::size_t node) const {
  return node == ode::event_degree ? to : from + (to - from) * ode::interpolation_nodes()[node];
}

/// Whether the samples at every second node show that a curved function stays far from zero.
bool EventSearch::is_far(std::size_t i) const {
  // NOTE: a dense output of degree 7 dips between five nodes (the relay loses events at loose tolerances).
  if (!five_nodes_suffice_ || !mode_.prefilter[i] || mode_.functions[i].sign == 0 || mode_.functions[i].zero_order != 0)
    return false;
  const auto value = [&](std::size_t node) { return samples_[node * mode_.functions.size() + i]; };
  return stays_far({value(0), value(2), value(4), value(6), value(8)}, mode_.functions[i].sign);
}

/// Whether what is special about the start of the step are zeros only that are left at once.
bool EventSearch::specials_leave(const ode::Stepper& stepper) {
  if (special_.empty()) return true;
  if (!stepper.mean_slopes(range_.low.data(), range_.high.data())) return false;
  const StepBounds slopes{0.0, 0.0, range_.low.data(), range_.high.data()};
  return std::all_of(special_.begin(), special_.end(), [&](std::size_t i) {
    return mode_.functions[i].sign != 0 && mode_.forms.has(i) && mode_.forms.leaves(i, mode_.functions[i].sign, slopes);
  });
}

/// Whether the range of a curved function over the step is on the side of its sign.
bool EventSearch::stays_away(std::size_t i) const {
  const auto& function = mode_.functions[i];
  if (!uses_phi(function) || function.kind == FunctionKind::nested) return false;
  if (function.sign == 0 || function.zero_order != 0 || function.offset != 0.0) return false;
  return function.sign * values_.middle[at(function.index)] > values_.radius[at(function.index)];
}

/// The curved functions that may vanish within the bounds of the step; returns whether there are any.
bool EventSearch::find_near() {
  range_.near_is_known = true;
  sampled_.clear();
  if (mode_.curved.empty()) return false;
  if (mode_.curved_parts.phi) {
    const auto& [begin, end, low, high] = range_.bounds;
    // What is within its rounding of zero, as the search knows it, may vanish.
    const double middle = 0.5 * (begin + end);
    values_.radii[0] = 0.5 * std::abs(end - begin) + rounding_of(std::abs(middle));
    for (std::size_t k = 0; k < x_.size(); ++k) {
      x_[k] = 0.5 * (low[k] + high[k]);
      values_.radii[1 + k] = 0.5 * (high[k] - low[k]) + rounding_of(std::abs(x_[k]));
    }
    kernel_.ranges(middle, x_.data(), mode_.state.alpha.data(), values_.radii.data(), values_.middle.data(),
                   values_.radius.data());
  }
  for (const std::size_t i : mode_.curved) {
    if (!stays_away(i)) sampled_.push_back(i);
  }
  return !sampled_.empty();
}

bool EventSearch::may_vanish(const ode::Stepper& stepper) {
  range_.known = range_.near_is_known = false;
  if (mode_.present == 0) return false;
  if (!specials_leave(stepper)) return true;
  return !range_.read(stepper) || mode_.forms.may_vanish(range_.bounds) || find_near();
}

/// The functions that the exact search has to look at.
void EventSearch::find_suspects(const ode::DenseStep& step) {
  suspects_.clear();
  const bool is_known = std::exchange(range_.near_is_known, false) && range_.known;
  range_.read(step);
  mode_.forms.append_suspects(range_.bounds, suspects_);
  for (const std::size_t i : special_) {
    if (mode_.forms.has(i)) suspects_.push_back(i);
  }
  if (is_known ? !sampled_.empty() : find_near()) {
    if (five_nodes_suffice_) sample(step, 0.0, 1.0, sampled_, {0, 2});
    for (const std::size_t i : sampled_) {
      if (!is_far(i)) suspects_.push_back(i);
    }
  }
  if (suspects_.size() > 1) std::sort(suspects_.begin(), suspects_.end());
}

/// The functions that the location of a hit has to look at: it retakes the step, whose end differs from the dense
/// output by the tolerance; bounds as wide again as the step moves, or a thousand tolerances, are on the safe side.
void EventSearch::find_candidates() {
  candidates_.clear();
  if (!mode_.curved.empty()) candidates_ = mode_.curved;
  mode_.forms.append_suspects(range_.widened(errors_.of_run()), candidates_);
  for (const std::size_t i : special_) {
    if (mode_.forms.has(i)) candidates_.push_back(i);
  }
  if (candidates_.size() > 1) std::sort(candidates_.begin(), candidates_.end());
}

SearchOutcome EventSearch::search(const ode::DenseStep& step, Location location, Hit& hit) {
  if (mode_.present == 0) return SearchOutcome::none;
  find_suspects(step);
  if (suspects_.empty()) return SearchOutcome::none;
  step.evaluate(0.0, x_.data());
  // Those between the ones that find_suspects has sampled.
  const Nodes rest = five_nodes_suffice_ ? Nodes{1, 2} : Nodes{0, 1};
  if (suspects_.size() == 1 && mode_.is_threshold(suspects_.front())) {  // the usual event
    set_noise(suspects_.front(), x_.data());
  } else if (are_away_at_start()) {
    sample(step, 0.0, 1.0, suspects_, rest);
    if (std::all_of(suspects_.begin(), suspects_.end(), [&](auto i) { return clearly_keeps_sign(step, i); }))
      return SearchOutcome::none;
    step.evaluate(0.0, x_.data());
    rescale(step.t, x_.data(), suspects_);
  } else {
    rescale(step.t, x_.data(), suspects_);
    sampled_.clear();
    for (const std::size_t i : suspects_) {
      if (!mode_.forms.has(i)) sampled_.push_back(i);
    }
    if (!sampled_.empty()) sample(step, 0.0, 1.0, sampled_, rest);
  }
  const SearchOutcome outcome = search_interval(step, 0.0, 1.0, 0, hit);
  if (outcome == SearchOutcome::hit) {
    if (!is_confirmed(step, hit)) hit.doubts = 6;
    // All of them whatever the bounds, or within bounds that hold for the location.
    if (suspects_.size() == mode_.present || location == Location::along) {
      candidates_ = suspects_;
      return outcome;
    }
    find_candidates();
    if (candidates_ == suspects_) return outcome;  // their roundings are known
    step.evaluate(0.0, x_.data());
    rescale(step.t, x_.data(), candidates_);
  }
  return outcome;
}

/// Whether the interpolant of function i misses the function's values between the nodes.
bool EventSearch::misses(const ode::DenseStep& step, double from, double to, std::size_t i,
                         const ode::BernsteinCoefficients& coefficients, double accuracy) {
  for (std::size_t k = 0; k < checked_places.size(); ++k) {
    auto& checks = checks_[k];
    if (checks.empty()) {  // one evaluation for all functions that ask
      const double theta = from + (to - from) * ode::check_nodes()[checked_places[k]];
      step.evaluate(theta, x_.data());
      evaluate_parts(step.t + theta * step.h, x_.data(), mode_.curved_parts);
      checks.resize(mode_.functions.size());
      for (const std::size_t j : suspects_) {
        if (!mode_.forms.has(j) && uses_phi(mode_.functions[j])) checks[j] = value(j, x_.data());
      }
    }
    const auto& weights = weights_at_checks()[k];
    const double interpolated = std::inner_product(weights.begin(), weights.end(), coefficients.begin(), 0.0);
    if (!(std::abs(checks[i] - interpolated) <= accuracy)) return true;
  }
  return false;
}

/// The first sign change of an affine function along the whole step, from the polynomials of the states.
EventSearch::Finding EventSearch::find_along(const ode::DenseStep& step, std::size_t i) const {
  const auto& function = mode_.functions[i];
  // The form has other roundings than the function, whose own terms may be smaller.
  const double rounding = std::max(levels_.noise[i], rounding_of(mode_.forms.terms(i, range_.bounds)));
  if (function.sign != 0) {
    auto along = mode_.forms.nested_along(i, step);
    along.c[0] -= function.offset;
    along.end -= function.offset;
    const auto zero = ode::plain_zero(along, function.sign, function.zero_order, rounding);
    if (zero.kind == ode::PlainZero::Kind::none) return {};
    if (zero.kind == ode::PlainZero::Kind::one) return {true, Hit{i, zero.theta, zero.slope / step.h, function.sign}};
  }
  auto coefficients = mode_.forms.along(i, step);
  if (function.offset != 0.0) {
    for (double& b : coefficients) b -= function.offset;
  }
  double size = 0.0;
  double none = 0.0;  // NaN if a coefficient is not finite: without a way out of the loop
  for (const double b : coefficients) {
    none += 0.0 * b;
    size = std::max(size, std::abs(b));
  }
  if (std::isnan(none)) return not_finite(function, coefficients.front());
  const double noise = std::max(rounding, rounding_of(size));
  const int sign = function.sign == 0 ? sign_behind_zero(coefficients, noise) : function.sign;
  if (sign == 0) return {};
  const auto change = ode::first_sign_change(coefficients, sign, function.zero_order, noise);
  if (!change) return {};
  const double theta = 0.5 * (change->lower + change->upper);
  return {true, Hit{i, theta, ode::derivative(coefficients, theta) / step.h, sign}};
}

/// Whether the interpolant of a curved function is good enough to tell its first sign change.
bool EventSearch::is_resolved(const ode::DenseStep& step, double from, double to, std::size_t i,
                              const Interpolant& interpolant) {
  const auto& [values, coefficients, sign, size] = interpolant;
  const auto& function = mode_.functions[i];
  const bool is_exit = !uses_phi(function);
  // Where the interpolant stays away from zero it need not be better than that distance; functions of time only, or
  // with a vanishing gradient, have no other measure than their own size.
  double margin = std::numeric_limits<double>::max();
  for (const double b : coefficients) margin = std::min(margin, sign * b);
  const double wanted = std::max({levels_.accuracy[i], 0.125 * margin, 0.1 * errors_.of_run().rtol * size});
  const double tail = chebyshev_tail(values);
  if (tail > wanted) {
    const bool known_zero = from == 0.0 && (function.zero_order > 0 || function.offset != 0.0);
    return is_exit && !known_zero && passes_once(coefficients, sign, tail, size);
  }
  return is_exit || !misses(step, from, to, i, coefficients, wanted);
}

/// The first sign change of one function between two nodes' ends, from the samples or, along the whole step, its form.
EventSearch::Finding EventSearch::find(const ode::DenseStep& step, double from, double to, std::size_t i) {
  if (step.is_series() && mode_.forms.has(i)) return find_in_series(step, from, to, i);
  if (mode_.forms.has(i) && from == 0.0 && to == 1.0) return find_along(step, i);
  const auto& function = mode_.functions[i];
  std::array<double, ode::event_nodes> values;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = samples_[k * mode_.functions.size() + i];
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    return not_finite(function, values.front());
  }
  const auto coefficients = ode::to_bernstein(values);
  const int sign = function.sign == 0 ? sign_behind_zero(values, levels_.noise[i]) : function.sign;
  if (sign == 0) return {};
  double size = 0.0;
  for (const double b : coefficients) size = std::max(size, std::abs(b));
  if (!mode_.forms.has(i) && !is_resolved(step, from, to, i, {values, coefficients, sign, size})) return {false, {}};
  double noise = std::max(levels_.noise[i], rounding_of(size));
  if (mode_.forms.has(i)) noise = std::max(noise, rounding_of(mode_.forms.terms(i, range_.bounds)));
  const auto change = ode::first_sign_change(coefficients, sign, from == 0.0 ? function.zero_order : 0, noise);
  if (!change) return {};
  const double local = 0.5 * (change->lower + change->upper);
  return {true,
          Hit{i, from + (to - from) * local, ode::derivative(coefficients, local) / ((to - from) * step.h), sign}};
}

/// The samples of [from, to] are taken (of the whole step those of curved functions); cuts the interval where an
/// interpolant is not good enough.
SearchOutcome EventSearch::search_interval(const ode::DenseStep& step, double from, double to, int depth, Hit& hit) {
  SearchOutcome outcome = SearchOutcome::none;
  bool resolved = true;
  for (std::size_t k = 0; k < suspects_.size() && resolved; ++k) {
    const auto finding = find_clear(step, from, to, suspects_[k]);
    resolved = finding.resolved;
    if (finding.hit && (outcome == SearchOutcome::none || finding.hit->theta < hit.theta)) {
      hit = *finding.hit;
      outcome = SearchOutcome::hit;
    }
  }
  if (resolved) return outcome;
  if (depth >= deepest) return SearchOutcome::unresolved;
  const double middle = 0.5 * (from + to);
  for (const auto& [begin, end] : {std::pair{from, middle}, std::pair{middle, to}}) {
    sample(step, begin, end, suspects_, {0, 1});
    const SearchOutcome half = search_interval(step, begin, end, depth + 1, hit);
    if (half != SearchOutcome::none) return half;
  }
  return SearchOutcome::none;
}

}  // namespace saltus::event_integrator
