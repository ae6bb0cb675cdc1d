#include "saltus/event_integrator/search/locate.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Newton steps before a slow correction (a multiple zero) is left to bisection.
constexpr int newton_steps = 8;
/// Longest way to an event, over the length of the step, that is not worth another step: the error of two stages,
/// dt^3/12 x''', is a rounding of what the step changes.
constexpr double two_stages_suffice = 1e-5;
/// The same for one stage, dt^2/2 x''.
constexpr double one_stage_suffices = 1e-8;

/// Part of the step that the rounding of a function may leave open before its zero counts as a multiple one. A simple
/// zero leaves about 1e-15 of it.
constexpr double flat_zero = 1e-9;

/// Lengths of steps: one that ends before the event, one that ends behind it.
struct Bracket {
  double before, beyond;
  double end = beyond;  ///< of the step, which may be on the first side again
  [[nodiscard]] double middle() const { return 0.5 * (before + beyond); }
  [[nodiscard]] double width() const { return beyond - before; }
  [[nodiscard]] bool holds(double h) const { return h > before && h < beyond; }
  /// Whether no step has ended behind the event.
  [[nodiscard]] bool is_open() const { return beyond == end; }
  /// Where to look next. While nobody knows where the other side is it may be a short dip: not farther than `reach`.
  [[nodiscard]] double inside(double reach) const { return is_open() ? std::min(middle(), before + reach) : middle(); }
};

/// The slope of Newton's method. That of the interpolant is good to many digits; only where it fails, near a double
/// zero, is a secant better.
class NewtonSlope {
 public:
  explicit NewtonSlope(double slope) : slope_(slope) {}
  [[nodiscard]] double value() const { return slope_; }
  void pass(double h, double value, bool flat, bool has_previous) {
    const bool fails = flat || std::abs(value) > 0.1 * std::abs(value_);
    if (has_previous && fails && h != h_ && value != value_) slope_ = (value - value_) / (h - h_);
    h_ = h;
    value_ = value;
  }

 private:
  double slope_, h_ = 0.0, value_ = 0.0;
};

}  // namespace

Locator::Locator(int states, ode::Stepper& stepper, ModeField& field, EventSearch& search,
                 const ode::Tolerances& tolerances)
    : stepper_(stepper), field_(field), search_(search), tolerances_(tolerances), n_(at(states)) {
  for (auto* x : {&trial_.x, &moved_.x, &slope_, &slope_ahead_, &x_, &located_.x}) x->resize(n_);
}

/// Steps that differ by less than this end at the same time.
double Locator::time_resolution() const { return 2.0 * rounding_unit * (std::abs(start_.t) + std::abs(trial_.h)); }

bool Locator::vanishes(double value) const {
  return value == 0.0 || std::abs(value) <= 0.125 * search_.noise(hit_.function);
}

/// At a multiple zero, (x - 1)^3, the rounding of the function where the step starts leaves the time open; where the
/// trial ends it is smaller by far.
void Locator::sharpen() {
  if (flat_) search_.rescale(start_.t + trial_.h, trial_.x.data());
}

/// Values of the candidates.
void Locator::evaluate(double t, const double* x, std::vector<double>& values) {
  search_.evaluate(t, x, search_.candidates(), values);
  values[place_] += left_;
}

bool Locator::take(double h) {
  if (h <= time_resolution()) {
    // The event is where the step starts: time cannot resolve the difference.
    trial_.h = 0.0;
    trial_.x.assign(start_.x, start_.x + n_);
    evaluate(start_.t, start_.x, trial_.values);
    return is_finite_at(trial_);
  }
  trial_.h = h;
  if (field_.attempt(stepper_, start_.t, start_.x, start_.slope, h, tolerances_) == ode::Attempt::undefined)
    return false;
  std::copy_n(stepper_.x_new(), n_, trial_.x.begin());
  const bool moved = field_.project(start_.t + h, trial_.x.data()) && !ode::is_implicit(stepper_.method());
  has_slope_ = !moved && !stepper_.follows();
  if (has_slope_) std::copy_n(stepper_.slope_new(), n_, slope_.begin());
  evaluate(start_.t + h, trial_.x.data(), trial_.values);
  return is_finite_at(trial_);
}

/// The point that lies dt ahead of the trial, into `moved_`; false where the field is undefined.
bool Locator::move(double dt) {
  const double t = start_.t + trial_.h + dt;
  for (std::size_t i = 0; i < n_; ++i) moved_.x[i] = trial_.x[i] + dt * slope_[i];
  if (std::abs(dt) > one_stage_suffices * trial_.h) {
    field_(t, moved_.x.data(), slope_ahead_.data());
    for (std::size_t i = 0; i < n_; ++i) moved_.x[i] = trial_.x[i] + 0.5 * dt * (slope_[i] + slope_ahead_[i]);
    slope_.swap(slope_ahead_);
  }
  moved_.h = trial_.h + dt;
  field_.project(t, moved_.x.data());
  evaluate(t, moved_.x.data(), moved_.values);
  return is_finite_at(moved_) && is_finite(moved_.x);
}

/// At the end of the trial, where that is not known.
void Locator::find_slope() {
  if (has_slope_) return;
  if (stepper_.follows()) {
    dense_->derivative(trial_.h / dense_->h, slope_.data());
  } else {
    field_(start_.t + trial_.h, trial_.x.data(), slope_.data());
  }
}

/// Moves the trial to the event if it is close enough for that; otherwise leaves it where it is.
bool Locator::finish(double slope) {
  if (ode::is_implicit(stepper_.method())) return false;
  double value = trial_.values[place_];
  double dt = -value / slope;
  if (!(std::abs(dt) <= two_stages_suffice * trial_.h)) return false;
  find_slope();
  for (int iteration = 0; iteration < 4; ++iteration) {
    if (!(trial_.h + dt > 0.0 && trial_.h + dt <= dense_->h) || !move(dt)) return false;
    const double next = moved_.values[place_];
    const bool small = std::abs(next) <= search_.noise(hit_.function);
    const bool converges = std::abs(next) <= 0.1 * std::abs(value);
    if (!converges && !small) return false;
    std::swap(trial_, moved_);
    if (vanishes(next) || !converges) return true;
    const double secant = (next - value) / dt;
    value = next;
    dt = -value / secant;
    if (std::abs(dt) <= time_resolution()) return true;
  }
  return false;
}

void Locator::set_hit(const Hit& hit) {
  hit_ = hit;
  const auto& candidates = search_.candidates();
  place_ = static_cast<std::size_t>(std::lower_bound(candidates.begin(), candidates.end(), hit.function) -
                                    candidates.begin());
  // What rounding has left of the function where the step starts is no part of a zero far behind: a row of cycles of
  // one step each would hand it on, and add what is left of every event.
  left_ = 0.0;
  const EventFunction& function = search_.functions()[hit.function];
  if (function.offset == 0.0) return;
  dense_->evaluate(0.5 * hit.theta, x_.data());
  evaluate(start_.t + 0.5 * hit.theta * dense_->h, x_.data(), beside_);
  if (function.has_left(beside_[place_])) left_ = function.offset;
}

/// Whether the trial ends at the event, or has been moved there. What is left within the rounding of the function
/// counts where it is the last digits of t.
bool Locator::has_arrived(double value, double slope) {
  const double t = start_.t + trial_.h;
  const double left = value / slope;
  const bool is_there = vanishes(value) && (flat_ || t - left == t || !(std::abs(left) <= time_resolution()));
  return is_there || trial_.h == 0.0 || (!flat_ && finish(slope));
}

/// Newton for the function of `hit`; the last trial is the result.
bool Locator::correct(const Hit& hit) {
  set_hit(hit);
  touches_ = false;
  flat_ = !(search_.noise(hit.function) <= flat_zero * std::abs(hit.slope) * dense_->h);
  NewtonSlope slope{hit.slope};
  double h = hit.theta * dense_->h;
  // A function that has left what is on the other side where the step starts has done so half way.
  Bracket bracket{left_ == 0.0 ? 0.0 : 0.5 * h, dense_->h};
  double reach = 0.0;
  // Halving a step down to rounding takes 50, and the growth of `reach` comes before.
  constexpr int most_iterations = 120;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!take(h)) {
      // Undefined: beyond the region where the field exists.
      bracket.beyond = h;
      h = bracket.middle();
      if (bracket.width() <= time_resolution()) return take(bracket.before);
      continue;
    }
    const double value = trial_.values[place_];
    sharpen();
    if (has_arrived(value, slope.value())) return true;
    (value * hit.sign > 0.0 ? bracket.before : bracket.beyond) = h;
    slope.pass(h, value, flat_, iteration > 0);
    const double left = value / slope.value();
    double next = h - left;
    const bool inside = bracket.holds(next);
    // A correction that leaves the bracket within rounding of its end has converged.
    if (!inside && !flat_ && std::abs(left) <= time_resolution()) return true;
    if (!inside || iteration >= newton_steps) {
      constexpr double growth = 8.0;
      reach = growth * std::max({reach, time_resolution(), std::abs(left)});
      next = bracket.inside(reach);
    }
    if (bracket.width() <= time_resolution() || (!flat_ && std::abs(next - h) <= time_resolution())) {
      // A function that touches zero: its interpolant has passed it by less than the tolerances, and it is far from
      // zero where the bracket ends with the step.
      constexpr double far = 1e3;
      touches_ = bracket.is_open() && value * hit.sign > far * search_.accuracy(hit.function);
      return true;
    }
    h = next;
  }
  return true;
}

/// Values of the candidates shortly before the trial's end, into `beside_`; returns how long before.
double Locator::look_back() {
  constexpr double shortly = 1e-3;
  const double back = shortly * trial_.h;
  dense_->evaluate((trial_.h - back) / dense_->h, x_.data());
  evaluate(start_.t + trial_.h - back, x_.data(), beside_);
  return back;
}

/// Values of the candidates shortly behind the start of the step, into `beside_`.
void Locator::look_ahead() {
  constexpr double share = 1e-3;
  dense_->evaluate(share, x_.data());
  evaluate(start_.t + share * dense_->h, x_.data(), beside_);
}

/// A function whose sign has changed beyond rounding at the located time: its zero lies earlier.
std::optional<std::size_t> Locator::earlier_function(std::size_t located) const {
  const auto& candidates = search_.candidates();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t i = candidates[k];
    if (i == located || sign(i) == 0 || !(trial_.values[k] * sign(i) < -search_.noise(i))) continue;
    const int function = search_.functions()[i].index;
    if (!search_.is_within_errors(function, trial_.values[k], start_.t + trial_.h, trial_.x.data())) return k;
  }
  return std::nullopt;
}

/// Where the event is at the start of the step: functions that are the located one by their values, as those of jumps
/// with one condition are. What else is near zero there may have left it, or not reached it yet.
void Locator::find_same_at_start(std::size_t located) {
  const auto& candidates = search_.candidates();
  look_ahead();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t i = candidates[k];
    const bool same = trial_.values[k] == trial_.values[place_] && beside_[k] == beside_[place_];
    if (i != located && same && left_ == 0.0 && sign(i) == hit_.sign) located_.functions.push_back(i);
  }
}

/// Functions that reach zero together with the located one: at zero to rounding of their values or of time, and away
/// from it shortly before (a surface just left is still near zero, but moving away).
void Locator::find_vanishing_with(std::size_t located) {
  const auto& candidates = search_.candidates();
  located_.functions.assign(1, located);
  if (candidates.size() == 1) return;
  if (trial_.h == 0.0) return find_same_at_start(located);
  const double back = look_back();
  const auto rate_of = [&](std::size_t k) { return sign(candidates[k]) * (beside_[k] - trial_.values[k]) / back; };
  // What implicit steps leave of the located one, their iteration leaves of functions that are the same.
  const double left = std::max(0.0, std::abs(trial_.values[place_]) / rate_of(place_));
  const double apart =
      2.0 * std::max(time_resolution(), !ode::is_implicit(stepper_.method()) || !std::isfinite(left) ? 0.0 : left);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t i = candidates[k];
    if (i == located || sign(i) == 0) continue;
    const double ahead = beside_[k] * sign(i);
    const double rate = rate_of(k);
    const double resolution = std::max(search_.noise(i), rate * apart);
    if (ahead > 2.0 * resolution && rate > 0.0 && std::abs(trial_.values[k]) <= resolution) {
      located_.functions.push_back(i);
    }
  }
}

const Located* Locator::locate(const StepStart& start, const ode::DenseStep& dense, Hit hit) {
  start_ = start;
  dense_ = &dense;
  if (!correct(hit)) return nullptr;
  for (std::size_t round = 0; round < search_.candidates().size(); ++round) {
    const auto earlier = earlier_function(hit.function);
    if (!earlier) break;
    const double h = trial_.h;
    const double value = trial_.values[*earlier];
    const std::size_t function = search_.candidates()[*earlier];
    hit = {function, h / dense.h, 0.0, search_.functions()[function].sign};
    // NOTE: not value / h, which leads Newton to h - h: 0, or a rounding beside it, where the step starts.
    const double back = look_back();
    hit.slope = (value - beside_[*earlier]) / back;
    if (!(hit.slope * hit.sign < 0.0)) hit.slope = 2.0 * value / h;
    if (!correct(hit)) return nullptr;
  }
  if (touches_) return nullptr;
  // A shorter step than the accepted one can only be worse where the field is singular (a selection that is 0/0).
  if (trial_.h > 0.0 && !(stepper_.error_norm() <= 2.0)) return nullptr;
  located_.t = start_.t + trial_.h;
  // Steps that begin before 0 end beside it to the rounding of their beginning. What is to happen at 0 would come again
  // there.
  if (std::abs(located_.t) <= time_resolution()) located_.t = 0.0;
  std::copy(trial_.x.begin(), trial_.x.end(), located_.x.begin());
  located_.short_of = trial_.values[place_] * hit.sign > search_.noise(hit.function);
  find_vanishing_with(hit.function);
  located_.signs.clear();
  for (const auto function : located_.functions) located_.signs.push_back(sign(function));
  return &located_;
}

}  // namespace saltus::event_integrator
