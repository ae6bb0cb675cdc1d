#include "saltus/event_integrator/event_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace saltus::event_integrator {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int deepest = 10;  // a step is cut into at most 2^10 pieces before it is shortened instead

int sign_of(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

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

/// Size of the last two Chebyshev coefficients of an interpolant: what the next ones may be expected to be.
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

bool uses_phi(const EventFunction& function) {
  return function.kind == FunctionKind::surface || function.kind == FunctionKind::user ||
         function.kind == FunctionKind::nested_below || function.kind == FunctionKind::nested_above;
}

/// d phi / d theta of an interpolant by a central difference: starts a Newton correction, no more.
double slope_at(const ode::BernsteinCoefficients& coefficients, double theta) {
  constexpr double width = 1e-4;
  const double below = std::max(0.0, theta - width);
  const double above = std::min(1.0, theta + width);
  return (ode::evaluate(coefficients, above) - ode::evaluate(coefficients, below)) / (above - below);
}

}  // namespace

EventSearch::EventSearch(const evaluation::ModelKernel& kernel, ModeField& field, ode::Method method,
                         const ode::Tolerances& tolerances)
    : kernel_(kernel),
      field_(field),
      five_nodes_suffice_(ode::dense_degree(method) <= 4),
      tolerances_(tolerances),
      forms_(at(kernel.states())) {
  for (int j = 0; j < kernel.event_functions(); ++j) nesting_.push_back(!kernel.inner(j).empty());
  const auto n_phi = at(kernel.event_functions());
  for (auto* vector : {&phi_, &phi_below_, &phi_above_, &magnitude_, &slope_}) vector->resize(n_phi);
  for (auto* vector : {&x_, &low_, &high_}) vector->resize(at(kernel.states()));
  user_sign_.assign(n_phi - at(kernel.switching_functions()), 0);
  user_vanishes_.assign(user_sign_.size(), false);
}

/// A step that led from one event to the next was not settled: the zeros at its start are history.
void EventSearch::start_at(double t) {
  if (zeros_at_ && *zeros_at_ != t) {
    for (auto& function : functions_) function.zero_order = 0;
    user_vanishes_.assign(user_vanishes_.size(), false);
  }
  zeros_at_ = t;
}

void EventSearch::enter(const ModeState& state, const std::vector<int>& zero_order, double t, const double* x) {
  state_ = state;
  start_at(t);
  functions_.clear();
  nested_ = false;
  const int n_psi = kernel_.switching_functions();
  for (int j = 0; j < n_psi; ++j) {
    if (state.mode[at(j)] == 0) continue;
    const bool around_sliding =
        nesting_[at(j)] && state.sliding.size() == 1 &&
        std::any_of(kernel_.inner(j).begin(), kernel_.inner(j).end(), [&](int i) { return state.mode[at(i)] == 0; });
    if (around_sliding) {
      const int below = state.corner_alpha[0][at(j)] > 0.5 ? 1 : -1;
      const int above = state.corner_alpha[1][at(j)] > 0.5 ? 1 : -1;
      nested_ = true;
      functions_.push_back({FunctionKind::nested_below, j, 0, below, zero_order[at(j)]});
      functions_.push_back({FunctionKind::nested_above, j, 0, above, zero_order[at(j)]});
    } else {
      functions_.push_back({FunctionKind::surface, j, 0, state.mode[at(j)], zero_order[at(j)]});
    }
  }
  exits_.resize(state.sliding.size());
  if (!state.sliding.empty()) field_.exits(t, x, exits_.data());
  for (std::size_t row = 0; row < state.sliding.size(); ++row) {
    const int r = static_cast<int>(row);
    // On a repelling surface (a forced mode) both fields leave and the signs are the other way round.
    const int arriving = exits_[row].below >= exits_[row].above ? +1 : -1;
    functions_.push_back({FunctionKind::exit_below, state.sliding[row], r, arriving});
    functions_.push_back({FunctionKind::exit_above, state.sliding[row], r, -arriving});
    if (field_.solve() == SlidingSolve::nonaffine) {
      functions_.push_back({FunctionKind::loss, state.sliding[row], r, sign_of(exits_[row].loss)});
    }
  }
  const auto is_held = [&](int u) {
    return std::any_of(held_.begin(), held_.end(), [u](const HeldGuard& guard) { return guard.hold.function == u; });
  };
  for (int u = n_psi; u < kernel_.event_functions(); ++u) {
    if (!is_held(u)) functions_.push_back({FunctionKind::user, u, 0, 0});
  }
  pressure_.resize(held_.size());
  for (std::size_t row = 0; row < held_.size(); ++row) {
    functions_.push_back({FunctionKind::release, held_[row].hold.function, static_cast<int>(row), held_[row].inward});
  }
  set_forms(x);
  noise_.assign(functions_.size(), 0.0);
  accuracy_.assign(functions_.size(), 0.0);
  point_.resize(functions_.size());
  samples_.resize(functions_.size() * ode::event_nodes);
  for (auto* list : {&suspects_, &special_, &curved_}) list->reserve(functions_.size());
  rescale(t, x);
  evaluate(t, x, point_);
  read_user_signs();
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    auto& function = functions_[i];
    const bool is_exit = function.kind == FunctionKind::exit_below || function.kind == FunctionKind::exit_above ||
                         function.kind == FunctionKind::release;
    // A selection that starts at its bound (tangential entry) leaves its exit function a zero there.
    if (is_exit && std::abs(point_[i]) <= noise_[i]) function.zero_order = 1;
    // The event was located to the last bits of the time, which are not the last bits of psi: what is left there is the
    // zero of this start.
    if (function.zero_order > 0) function.offset = point_[i];
  }
  sort_functions();
}

/// The affine functions of the mode as forms. Selections of a mode are constants, so a function that holds some is
/// affine if it is for each value of theirs.
void EventSearch::set_forms(const double* x) {
  const bool selections = std::find(nesting_.begin(), nesting_.end(), true) != nesting_.end();
  if (rows_[0].start.empty() || selections) {
    kernel_.affine_rows(state_.alpha.data(), rows_[0]);
    forms_.load(rows_[0]);
  }
  if (nested_) {
    kernel_.affine_rows(state_.corner_alpha[0].data(), rows_[1]);
    kernel_.affine_rows(state_.corner_alpha[1].data(), rows_[2]);
  }
  forms_.reset(functions_.size());
  curved_.clear();
  curved_phi_ = curved_exits_ = false;
  prefilter_.assign(functions_.size(), false);
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    const auto& function = functions_[i];
    switch (function.kind) {
      case FunctionKind::surface:
      case FunctionKind::user:
        forms_.use_row(i, at(function.index));
        break;
      case FunctionKind::nested_below:
        forms_.set(i, rows_[1], at(function.index));
        break;
      case FunctionKind::nested_above:
        forms_.set(i, rows_[2], at(function.index));
        break;
      case FunctionKind::exit_below:
      case FunctionKind::exit_above: {
        const auto side = function.kind == FunctionKind::exit_below ? Region::below : Region::above;
        if (field_.exit_row(at(function.row), side, x, row_)) forms_.set(i, row_);
        break;
      }
      case FunctionKind::loss:
      case FunctionKind::release:
        break;
    }
    if (forms_.has(i)) continue;
    curved_.push_back(i);
    (uses_phi(function) ? curved_phi_ : curved_exits_) = true;
    // Functions that are not affine in the state may oscillate within a step: five nodes do not speak for them.
    prefilter_[i] = five_nodes_suffice_ && !uses_phi(function);
  }
}

/// What is watched by its form, and what is looked at in every step because its start is special.
void EventSearch::sort_functions() {
  forms_.watch_none();
  special_.clear();
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    const auto& function = functions_[i];
    if (function.sign == 0 || function.zero_order != 0 || function.offset != 0.0) {
      special_.push_back(i);
    } else if (forms_.has(i)) {
      forms_.watch(i, function.sign);
    }
  }
}

/// From the values in point_.
void EventSearch::read_user_signs() {
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    auto& function = functions_[i];
    if (function.kind != FunctionKind::user) continue;
    const auto user = at(function.index - kernel_.switching_functions());
    auto& sign = user_sign_[user];
    const bool at_zero = user_vanishes_[user] || std::abs(point_[i]) <= noise_[i];
    if (!at_zero) sign = sign_of(point_[i]);
    function.sign = sign;
    function.zero_order = at_zero ? 1 : 0;
  }
}

void EventSearch::find_pressure(double t, const double* x) {
  if (held_.empty()) return;
  kernel_.hold_pressure(t, x, field_.alpha().data(), pressure_.data());
}

void EventSearch::rescale(double t, const double* x) {
  kernel_.scales(t, x, state_.alpha.data(), magnitude_.data(), slope_.data());
  if (!exits_.empty()) field_.exits(t, x, exits_.data());
  find_pressure(t, x);
  for (std::size_t i = 0; i < functions_.size(); ++i) set_noise(i);
}

void EventSearch::set_noise(std::size_t i) {
  const auto& function = functions_[i];
  if (uses_phi(function)) {
    const auto j = at(function.index);
    // A handful of roundings of terms as large as the magnitude.
    noise_[i] = 8.0 * epsilon * magnitude_[j];
    accuracy_[i] = 0.1 * (tolerances_.atol * slope_[j] + tolerances_.rtol * magnitude_[j]);
  } else if (function.kind == FunctionKind::release) {
    const double size = std::abs(pressure_[at(function.row)]);
    noise_[i] = 32.0 * epsilon * size;
    accuracy_[i] = 0.1 * tolerances_.rtol * size;
  } else {
    const auto& exit = exits_[at(function.row)];
    const double size =
        function.kind == FunctionKind::loss ? std::abs(exit.loss) : std::abs(exit.below) + std::abs(exit.above);
    noise_[i] = 32.0 * epsilon * size;
    // Near a two-fold point both fields vanish, but not the terms they are the sum of.
    if (field_.solve() == SlidingSolve::decoupled) {
      noise_[i] = std::max(noise_[i], 8.0 * epsilon * field_.normal_terms(at(function.row)));
    }
    accuracy_[i] = 0.1 * tolerances_.rtol * size;
  }
  if (!std::isfinite(noise_[i])) noise_[i] = 0.0;
  accuracy_[i] = std::isfinite(accuracy_[i]) ? std::max(accuracy_[i], noise_[i]) : 0.0;
}

void EventSearch::evaluate_parts(double t, const double* x, Needed needed) {
  const bool phi = needed == Needed::all || curved_phi_;
  if (phi) kernel_.functions(t, x, state_.alpha.data(), phi_.data());
  if (phi && nested_) {
    kernel_.functions(t, x, state_.corner_alpha[0].data(), phi_below_.data());
    kernel_.functions(t, x, state_.corner_alpha[1].data(), phi_above_.data());
  }
  if (needed == Needed::all || curved_exits_) {
    if (!exits_.empty()) field_.exits(t, x, exits_.data());
    find_pressure(t, x);
  }
}

/// Value of function i at the point that evaluate_parts was last called with.
double EventSearch::part(std::size_t i) const {
  const auto& function = functions_[i];
  switch (function.kind) {
    case FunctionKind::surface:
    case FunctionKind::user:
      return phi_[at(function.index)] - function.offset;
    case FunctionKind::nested_below:
      return phi_below_[at(function.index)] - function.offset;
    case FunctionKind::nested_above:
      return phi_above_[at(function.index)] - function.offset;
    case FunctionKind::exit_below:
      return exits_[at(function.row)].below - function.offset;
    case FunctionKind::exit_above:
      return exits_[at(function.row)].above - function.offset;
    case FunctionKind::loss:
      return exits_[at(function.row)].loss - function.offset;
    case FunctionKind::release:
      return pressure_[at(function.row)] - function.offset;
  }
  __builtin_unreachable();
}

void EventSearch::evaluate(double t, const double* x, std::vector<double>& values) {
  evaluate_parts(t, x, Needed::all);
  for (std::size_t i = 0; i < functions_.size(); ++i) values[i] = part(i);
}

void EventSearch::sample_node(const ode::DenseStep& step, double theta, std::size_t node,
                              const std::vector<std::size_t>& which) {
  const double t = step.t + theta * step.h;
  step.evaluate(theta, x_.data());
  if (!curved_.empty()) evaluate_parts(t, x_.data(), Needed::curved);
  double* samples = samples_.data() + node * functions_.size();
  for (const std::size_t i : which) {
    samples[i] = forms_.has(i) ? forms_.value(i, t, x_.data()) - functions_[i].offset : part(i);
  }
}

double EventSearch::node_theta(double from, double to, std::size_t node) const {
  return node == ode::event_degree ? to : from + (to - from) * ode::interpolation_nodes()[node];
}

/// Whether the samples at every second node show that a curved function stays far from zero.
bool EventSearch::is_far(std::size_t i) const {
  // NOTE: a dense output of degree 7 dips between five nodes (the relay loses events at loose tolerances).
  if (!prefilter_[i] || functions_[i].sign == 0 || functions_[i].zero_order != 0) return false;
  const auto value = [&](std::size_t node) { return samples_[node * functions_.size() + i]; };
  return stays_far({value(0), value(2), value(4), value(6), value(8)}, functions_[i].sign);
}

bool EventSearch::may_vanish(const ode::Stepper& stepper) {
  if (functions_.empty()) return false;
  if (!curved_.empty() || !special_.empty()) return true;
  if (!stepper.bounds(low_.data(), high_.data())) return true;
  bounds_ = {stepper.start_time(), stepper.start_time() + stepper.length(), low_.data(), high_.data()};
  return forms_.may_vanish(bounds_);
}

/// The functions that the exact search has to look at.
void EventSearch::find_suspects(const ode::DenseStep& step) {
  suspects_.clear();
  bounds_ = {step.t, step.t + step.h, low_.data(), high_.data()};
  step.bounds(low_.data(), high_.data());
  forms_.append_suspects(bounds_, suspects_);
  for (const std::size_t i : special_) {
    if (forms_.has(i)) suspects_.push_back(i);
  }
  if (!curved_.empty()) {
    if (five_nodes_suffice_) {
      for (std::size_t node = 0; node < ode::event_nodes; node += 2) {
        sample_node(step, node_theta(0.0, 1.0, node), node, curved_);
      }
    }
    for (const std::size_t i : curved_) {
      if (!is_far(i)) suspects_.push_back(i);
    }
  }
  std::sort(suspects_.begin(), suspects_.end());
}

SearchOutcome EventSearch::search(const ode::DenseStep& step, Hit& hit) {
  if (functions_.empty()) return SearchOutcome::none;
  find_suspects(step);
  if (suspects_.empty()) return SearchOutcome::none;
  step.evaluate(0.0, x_.data());
  kernel_.scales(step.t, x_.data(), state_.alpha.data(), magnitude_.data(), slope_.data());
  const bool exits = std::any_of(suspects_.begin(), suspects_.end(), [&](auto i) { return !uses_phi(functions_[i]); });
  if (exits && !exits_.empty()) field_.exits(step.t, x_.data(), exits_.data());
  if (exits) find_pressure(step.t, x_.data());
  for (const std::size_t i : suspects_) set_noise(i);
  for (std::size_t node = 0; node < ode::event_nodes; ++node) {
    sample_node(step, node_theta(0.0, 1.0, node), node, suspects_);
  }
  const SearchOutcome outcome = search_interval(step, 0.0, 1.0, 0, hit);
  if (outcome == SearchOutcome::hit) {  // its location asks for the noise of every function
    step.evaluate(0.0, x_.data());
    rescale(step.t, x_.data());
  }
  return outcome;
}

/// Whether the interpolant of function i misses the function's values between the nodes.
bool EventSearch::misses(const ode::DenseStep& step, double from, double to, std::size_t i,
                         const ode::BernsteinCoefficients& coefficients, double accuracy) {
  // Three places that are not symmetric to each other: a periodic function does not fool the nodes and these as well.
  for (const std::size_t place : {std::size_t{0}, std::size_t{3}, std::size_t{6}}) {
    const double local = ode::check_nodes()[place];
    const double theta = from + (to - from) * local;
    step.evaluate(theta, x_.data());
    evaluate_parts(step.t + theta * step.h, x_.data(), Needed::curved);
    if (!(std::abs(part(i) - ode::evaluate(coefficients, local)) <= accuracy)) return true;
  }
  return false;
}

/// The first sign change of one function between two nodes' ends, from the samples.
EventSearch::Finding EventSearch::find(const ode::DenseStep& step, double from, double to, std::size_t i) {
  const auto& function = functions_[i];
  std::array<double, ode::event_nodes> values;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = samples_[k * functions_.size() + i];
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return {false, {}};
  const auto coefficients = ode::to_bernstein(values);
  int sign = function.sign;
  if (sign == 0) {  // a user function at zero: it gets the sign it moves to
    const auto first =
        std::find_if(coefficients.begin(), coefficients.end(), [&](double b) { return std::abs(b) > noise_[i]; });
    if (first == coefficients.end()) return {};
    sign = sign_of(*first);
  }
  const int zero_order = from == 0.0 ? function.zero_order : 0;
  if (!forms_.has(i)) {
    const bool is_exit = !uses_phi(function);
    // Where the interpolant stays away from zero it need not be better than that distance; functions of time only, or
    // with a vanishing gradient, have no other measure than their own size.
    double margin = std::numeric_limits<double>::max();
    double size = 0.0;
    for (const double b : coefficients) {
      margin = std::min(margin, sign * b);
      size = std::max(size, std::abs(b));
    }
    const double wanted = std::max({accuracy_[i], 0.125 * margin, 0.1 * tolerances_.rtol * size});
    if (chebyshev_tail(values) > wanted || (!is_exit && misses(step, from, to, i, coefficients, wanted))) {
      return {false, {}};
    }
  }
  double noise = noise_[i];
  // The form has other roundings than the function, whose own terms may be smaller.
  if (forms_.has(i)) noise = std::max(noise, 8.0 * epsilon * forms_.terms(i, bounds_));
  for (const double b : coefficients) noise = std::max(noise, 8.0 * epsilon * std::abs(b));
  if (ode::certainly_no_sign_change(coefficients, sign, zero_order, noise)) return {};
  const auto change = ode::first_sign_change(coefficients, sign, zero_order, noise);
  if (!change) return {};
  const double local = 0.5 * (change->lower + change->upper);
  return {true, Hit{i, from + (to - from) * local, slope_at(coefficients, local) / ((to - from) * step.h), sign}};
}

/// The samples of [from, to] are taken; cuts the interval where an interpolant is not good enough.
SearchOutcome EventSearch::search_interval(const ode::DenseStep& step, double from, double to, int depth, Hit& hit) {
  SearchOutcome outcome = SearchOutcome::none;
  bool resolved = true;
  for (std::size_t k = 0; k < suspects_.size() && resolved; ++k) {
    const auto finding = find(step, from, to, suspects_[k]);
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
    for (std::size_t node = 0; node < ode::event_nodes; ++node) {
      sample_node(step, node_theta(begin, end, node), node, suspects_);
    }
    const SearchOutcome half = search_interval(step, begin, end, depth + 1, hit);
    if (half != SearchOutcome::none) return half;
  }
  return SearchOutcome::none;
}

bool EventSearch::settle(double t, const double* x) {
  user_vanishes_.assign(user_vanishes_.size(), false);
  zeros_at_ = t;
  if (special_.empty()) return false;
  bool unknown = false;
  const bool offset =
      std::any_of(special_.begin(), special_.end(), [&](auto i) { return functions_[i].offset != 0.0; });
  if (offset) evaluate(t, x, point_);
  std::size_t kept = 0;
  for (const std::size_t i : special_) {
    auto& function = functions_[i];
    function.zero_order = 0;
    unknown = unknown || function.sign == 0;
    // Far enough behind the start that what was left there cannot be mistaken for a new zero.
    if (function.offset != 0.0 && function.sign * point_[i] > 2.0 * std::abs(function.offset)) function.offset = 0.0;
    if (function.offset != 0.0 || function.sign == 0) {
      special_[kept++] = i;
    } else if (forms_.has(i)) {
      forms_.watch(i, function.sign);
    }
  }
  special_.resize(kept);
  if (!unknown) return false;
  rescale(t, x);
  evaluate(t, x, point_);
  read_user_signs();
  sort_functions();
  return true;
}

void EventSearch::set_user_signs(std::vector<int> signs, std::vector<bool> vanish) {
  user_sign_ = std::move(signs);
  user_vanishes_ = std::move(vanish);
  zeros_at_.reset();
}

void EventSearch::set_user_sign(std::size_t function, int sign, double t, const double* x) {
  start_at(t);
  auto& entry = functions_[function];
  const auto user = at(entry.index - kernel_.switching_functions());
  entry.sign = sign;
  entry.zero_order = 1;
  kernel_.functions(t, x, state_.alpha.data(), phi_.data());
  entry.offset = phi_[at(entry.index)];
  user_sign_[user] = sign;
  user_vanishes_[user] = true;
  sort_functions();
}

}  // namespace saltus::event_integrator
