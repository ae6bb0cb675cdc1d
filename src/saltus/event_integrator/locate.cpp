#include "saltus/event_integrator/locate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::event_integrator {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// One event under correction: values of all functions at the end of the retaken step.
struct Trial {
  double h = 0.0;
  std::vector<double> x;
  std::vector<double> values;
};

class Locator {
 public:
  Locator(ode::Stepper& stepper, ModeField& field, EventSearch& search, const ode::Tolerances& tolerances,
          const StepStart& start, const ode::DenseStep& dense)
      : stepper_(stepper), field_(field), search_(search), tolerances_(tolerances), start_(start), dense_(dense) {
    trial_.values.resize(search.functions().size());
    n_ = static_cast<std::size_t>(dense.size());
  }

  std::optional<Located> run(Hit hit);

 private:
  bool take(double h);
  bool correct(const Hit& hit);
  [[nodiscard]] std::optional<std::size_t> earlier_function(std::size_t located) const;
  [[nodiscard]] std::vector<std::size_t> vanishing_with(std::size_t located);
  [[nodiscard]] int sign(std::size_t function) const {
    return function == hit_.function ? hit_.sign : search_.functions()[function].sign;
  }
  /// Steps that differ by less than this end at the same time.
  [[nodiscard]] double time_resolution() const { return 2.0 * epsilon * (std::abs(start_.t) + std::abs(trial_.h)); }
  /// Newton steps before a slow correction (a multiple zero) is left to bisection.
  static constexpr int newton_steps = 8;

  ode::Stepper& stepper_;
  ModeField& field_;
  EventSearch& search_;
  const ode::Tolerances& tolerances_;
  const StepStart& start_;
  const ode::DenseStep& dense_;
  std::size_t n_ = 0;
  Hit hit_;
  Trial trial_;
};

bool Locator::take(double h) {
  if (h <= time_resolution()) {
    // The event is where the step starts: time cannot resolve the difference.
    trial_.h = 0.0;
    trial_.x.assign(start_.x, start_.x + n_);
    search_.evaluate(start_.t, start_.x, trial_.values);
    return std::isfinite(trial_.values[hit_.function]);
  }
  const auto f = [this](double t, const double* x, double* xdot) { field_(t, x, xdot); };
  trial_.h = h;
  if (stepper_.attempt(f, start_.t, start_.x, start_.slope, h, tolerances_) == ode::Attempt::undefined) return false;
  trial_.x.assign(stepper_.x_new(), stepper_.x_new() + n_);
  field_.project(start_.t + h, trial_.x.data());
  search_.evaluate(start_.t + h, trial_.x.data(), trial_.values);
  return std::isfinite(trial_.values[hit_.function]);
}

/// Newton for the function of `hit`; the last trial is the result.
bool Locator::correct(const Hit& hit) {
  hit_ = hit;
  double before = 0.0;       // longest step seen that ends before the event
  double beyond = dense_.h;  // shortest one that ends behind it
  double slope = hit.slope;
  double h = hit.theta * dense_.h;
  double previous_h = 0.0;
  double previous_value = 0.0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (!take(h)) {
      // Undefined: beyond the region where the field exists.
      beyond = h;
      h = 0.5 * (before + beyond);
      if (beyond - before <= time_resolution()) return take(before);
      continue;
    }
    const double value = trial_.values[hit.function];
    if (value == 0.0 || std::abs(value) <= 0.125 * search_.noise(hit.function) || trial_.h == 0.0) return true;
    (value * hit.sign > 0.0 ? before : beyond) = h;
    // The interpolant's slope is good to many digits; only where it fails (near a double zero) is a secant better.
    if (iteration > 0 && std::abs(value) > 0.1 * std::abs(previous_value) && h != previous_h &&
        value != previous_value) {
      slope = (value - previous_value) / (h - previous_h);
    }
    previous_h = h;
    previous_value = value;
    double next = h - value / slope;
    if (!(next > before && next < beyond)) {
      // The correction left the bracket: within rounding of its end that is convergence, otherwise bisect.
      if (std::abs(value / slope) <= time_resolution()) return true;
      next = 0.5 * (before + beyond);
    }
    if (iteration >= newton_steps) next = 0.5 * (before + beyond);
    if (std::abs(next - h) <= time_resolution() || beyond - before <= time_resolution()) return true;
    h = next;
  }
  return true;
}

/// A function whose sign has changed beyond rounding at the located time: its zero lies earlier.
std::optional<std::size_t> Locator::earlier_function(std::size_t located) const {
  for (std::size_t i = 0; i < trial_.values.size(); ++i) {
    if (i != located && sign(i) != 0 && trial_.values[i] * sign(i) < -search_.noise(i)) return i;
  }
  return std::nullopt;
}

/// Functions that reach zero together with the located one: at zero to rounding of their values or of time, and away
/// from it shortly before (a surface just left is still near zero, but moving away).
std::vector<std::size_t> Locator::vanishing_with(std::size_t located) {
  std::vector<std::size_t> together{located};
  std::vector<double> x(n_);
  std::vector<double> earlier(trial_.values.size());
  const double back = 1e-3 * trial_.h;
  if (back == 0.0) return together;
  dense_.evaluate((trial_.h - back) / dense_.h, x.data());
  search_.evaluate(start_.t + trial_.h - back, x.data(), earlier);
  for (std::size_t i = 0; i < trial_.values.size(); ++i) {
    if (i == located || sign(i) == 0) continue;
    const double ahead = earlier[i] * sign(i);
    const double rate = (ahead - trial_.values[i] * sign(i)) / back;
    const double resolution = std::max(search_.noise(i), 2.0 * rate * time_resolution());
    if (ahead > 2.0 * resolution && rate > 0.0 && std::abs(trial_.values[i]) <= resolution) together.push_back(i);
  }
  return together;
}

std::optional<Located> Locator::run(Hit hit) {
  if (!correct(hit)) return std::nullopt;
  for (std::size_t round = 0; round < search_.functions().size(); ++round) {
    const auto earlier = earlier_function(hit.function);
    if (!earlier) break;
    const double h = trial_.h;
    const double value = trial_.values[*earlier];
    hit = {*earlier, h / dense_.h, value, search_.functions()[*earlier].sign};
    // A slope from the sign change itself: the value falls from noise to `value` somewhere before h.
    hit.slope = value / h;
    if (!correct(hit)) return std::nullopt;
  }
  // A shorter step than the accepted one can only be worse where the field is singular (a selection that is 0/0).
  if (trial_.h > 0.0 && !(stepper_.error_norm() <= 2.0)) return std::nullopt;
  Located located;
  located.t = start_.t + trial_.h;
  const Trial final = trial_;
  located.functions = vanishing_with(hit.function);
  for (const auto function : located.functions) located.signs.push_back(sign(function));
  located.x = final.x;
  return located;
}

}  // namespace

std::optional<Located> locate(ode::Stepper& stepper, ModeField& field, EventSearch& search,
                              const ode::Tolerances& tolerances, const StepStart& start, const ode::DenseStep& dense,
                              Hit hit) {
  return Locator(stepper, field, search, tolerances, start, dense).run(hit);
}

}  // namespace saltus::event_integrator
