// Sliding on a function that has a root of another one inside it (terminal sliding modes): the motion runs into the
// zero of that one in finite time, like a power of the time that is left, and no field goes on beyond.
#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// The functions of the mode that this may happen to.
void Run::watch_nested_roots() {
  if (!nearing_.empty()) tolerances_.lift(StepTolerances::Reason::zeros);
  nearing_.clear();
  nearing_since_ = here_.t;
  for (const int j : here_.state.sliding) {
    for (const int i : kernel_.inner(j)) {
      if (here_.state.mode[at(i)] == 0 || !kernel_.has_root_inside(j, i)) continue;
      const auto is_it = [i](const Nearing& other) { return other.function == i; };
      auto place = std::find_if(nearing_.begin(), nearing_.end(), is_it);
      if (place == nearing_.end()) place = nearing_.insert(place, Nearing{i, {}});
      place->around.push_back(j);
    }
  }
}

/// Errors of g move the time that is left, p |g / g'|, in proportion: with g as accurate as a state of its size may be,
/// those of the last steps add to rtol like a geometric series.
void Run::tighten_beside_nested_roots(double& atol, double& rtol) {
  // Where g is a difference of states, its rounding moves the selection, which is of the size of |g'|^2 / g, by a part
  // of u / g: less than this could not be reached any more before g is as small as it may get.
  const double smallest = 1e-12 / tolerances_.mode().rtol;
  for (const Nearing& nearing : nearing_) {
    const Rate rate = rates_.here(nearing.function);
    const double wanted = tolerances_.mode().rtol * std::abs(rooted_values_[at(nearing.function)]);
    if (!(wanted > 0.0)) continue;
    atol = std::min(atol, wanted / (rate.slope * tolerances_.mode().atol));
    rtol = std::min(rtol, std::max(smallest, wanted / (rate.magnitude * tolerances_.mode().rtol)));
  }
}

/// When g is 0, once that is known far better than the tolerance asks for and little is left until then: g goes like
/// (T - t)^p, so that |g / g'| = (T - t)/p, less what is of higher order in T - t. p follows from where it has halved;
/// that T is right from the one that the halving before has given.
std::optional<double> Run::end_of_nearing(Nearing& nearing) {
  constexpr double little = 1e-3;  // of the time since the mode began: exits and other events are looked for until then
  constexpr double agree = 0.1;    // of the tolerance of a step, over that time; the error itself is a third of it
  constexpr double bent = 1.02;    // of zeros that are crossed p is 1, to `little`
  const double g = rooted_values_[at(nearing.function)];
  const Rate rate = rates_.here(nearing.function);
  const double ratio = g == 0.0 ? 0.0 : -g / rate.value;
  const double since = here_.t - nearing_since_;
  const double resolved = 16.0 * here_.smallest_step();
  const Nearing last = nearing;
  const double power = (here_.t - last.t) / (last.ratio - ratio);
  const double left = power * ratio;
  const bool turns = !(ratio >= 0.0) || ratio > last.ratio || !std::isfinite(last.ratio);
  const bool halved = !turns && ratio <= 0.5 * last.ratio;
  if (turns || halved) {
    nearing.t = here_.t;
    nearing.ratio = ratio;
    nearing.end = turns ? std::numeric_limits<double>::quiet_NaN() : here_.t + left;
  }
  if (turns || !(power > bent)) return std::nullopt;
  const bool agrees =
      std::abs(here_.t + left - last.end) <= std::max(agree * tolerances_.mode().rtol * since, 0.25 * resolved);
  const bool rounds = std::abs(g) <= 1e5 * 8.0 * rounding_unit * rate.magnitude;  // five digits of g are left
  if (left <= resolved || (halved && left <= little * since && (agrees || rounds))) return here_.t + left;
  return std::nullopt;
}

/// The point where these of nearing_ are 0: by a parabola through the last two slopes, then onto the set. nullopt where
/// states that the set does not fix bend too much for that, or something else happens before.
std::optional<Located> Run::at_nested_roots(double end, const std::vector<std::size_t>& reached) {
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
    hold(nearing_[k].function);
    for (const int j : nearing_[k].around) hold(j);
    const auto& functions = search_.functions();
    const auto is_it = [&](const EventFunction& function) {
      return function.kind == FunctionKind::surface && function.index == nearing_[k].function;
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
  for (Eigen::Index i = 0; i < set.rows().cols(); ++i) on_set += set.rows().col(i).isZero(0.0) ? 0U : 1U;
  const bool fixed = on_set <= held.size();
  for (std::size_t i = 0; i < here_.x.size(); ++i) {
    const double bend = 0.5 * left * (here_.slope[i] - nearing_slope_[i]) * std::min(1.0, left / nearing_step_);
    located.x[i] += left * here_.slope[i] + bend;
    const bool is_fixed = fixed && !set.rows().col(static_cast<Eigen::Index>(i)).isZero(0.0);
    const double tolerance = tolerances_.mode().atol + tolerances_.mode().rtol * std::abs(here_.x[i]);
    if (!is_fixed && left > 16.0 * here_.smallest_step() && !(std::abs(bend) <= tolerance)) return std::nullopt;
  }
  static_cast<void>(set.project(end, located.x.data()));
  if (!is_finite(located.x)) return std::nullopt;
  const auto before = all_functions(here_.t, here_.x.data());
  const auto after = all_functions(end, located.x.data());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool is_it = std::find(located.functions.begin(), located.functions.end(), i) != located.functions.end();
    const auto kind = search_.functions()[i].kind;
    const bool has_value = kind == FunctionKind::surface || kind == FunctionKind::user || is_cell_end(kind);
    if (!is_it && has_value && before[i] * after[i] < 0.0) return std::nullopt;
  }
  return located;
}

/// Where functions that the motion runs into the zeros of get there, together with those that do within their accuracy.
std::optional<Located> Run::nested_roots_ahead() {
  rooted_values_.resize(at(kernel_.event_functions()));
  kernel_.functions(here_.t, here_.x.data(), here_.state.alpha.data(), rooted_values_.data());
  std::optional<double> first;
  for (Nearing& nearing : nearing_) {
    const auto end = end_of_nearing(nearing);
    if (end && (!first || *end < *first)) first = end;
  }
  if (!first || *first >= std::min({options_.until, jumps_.next_time(), next_departure()})) return std::nullopt;
  std::vector<std::size_t> reached;
  const double together = std::max(tolerances_.mode().rtol * (*first - nearing_since_), 16.0 * here_.smallest_step());
  for (std::size_t k = 0; k < nearing_.size(); ++k) {
    if (std::abs(nearing_[k].end - *first) <= together) reached.push_back(k);
  }
  return at_nested_roots(*first, reached);
}

/// Over the rest of the way, with the rows in it: on parabolas that begin with the slopes here.
Run::Step Run::arrive_at_nested_roots(const Located& located) {
  const double h = located.t - here_.t;
  rows_.write_before(located.t, [&](double t, double* x) {
    const double s = (t - here_.t) / h;
    for (std::size_t k = 0; k < here_.x.size(); ++k) {
      const double mean = (located.x[k] - here_.x[k]) / h;
      x[k] = here_.x[k] + h * s * (here_.slope[k] + s * (mean - here_.slope[k]));
    }
  });
  // Selections are 0/0 at the end: those of the last step are theirs to what changes over this way.
  field_(here_.t, here_.x.data(), free_slope_.data());
  if (is_finite(field_.alpha())) here_.state.alpha = field_.alpha();
  // The last steps may have been short because of rounding.
  here_.time_scale = std::max({here_.time_scale, located.t - here_.t, 1e-3 * (here_.t - nearing_since_)});
  return handle(located);
}

/// Away from where a function is 0 with one that it has a root of, in a field that knows of no root: beside that point
/// a dense output may be on the side where the root is undefined. The first step is searched at its end only.
void Run::leave_nested_root() {
  const double limit = std::min({options_.until, jumps_.next_time(), next_departure()});
  const auto is_in_mode = [&](double t) {
    const auto values = all_functions(t, steps_.stepper().x_new());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = search_.functions()[i];
      if (function.kind == FunctionKind::surface && !(values[i] * function.sign > 0.0)) return false;
      if (values[i] * function.sign < 0.0) return false;
    }
    return true;
  };
  for (double h = root_step(); h > here_.smallest_step(); h *= 0.25) {
    const double t_new = std::min(here_.t + h, limit);
    if (steps_.take(t_new) == ode::Attempt::finite && steps_.error_norm() <= 1.0 && is_in_mode(t_new) &&
        steps_.remake_dense()) {
      steps_.set_length(t_new - here_.t);
      static_cast<void>(accept(t_new));
      return;
    }
    ++result_.statistics.rejected;
  }
}

}  // namespace saltus::event_integrator
