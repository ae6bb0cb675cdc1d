#include "saltus/ode/step_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"

namespace saltus::ode {
namespace {

/// Power of h in the error norm, about: what the exponents of the controllers are made for. The estimate of a Radau
/// method is of the order of its stages, as its dense output.
int error_order(Method method) { return (is_implicit(method) ? dense_degree(method) : order(method)) + 1; }

/// Constants of the codes DOPRI5, DOP853 and RADAU5 of Hairer & Wanner.
struct Gains {
  double exponent;  ///< of the error of this step
  double beta;      ///< of the error of the step before: 0 is the plain controller
  double smallest;  ///< factor
  double largest;
};

Gains gains(Method method) {
  switch (method) {
    case Method::dopri5:
      return {.exponent = 0.2 - 0.75 * 0.04, .beta = 0.04, .smallest = 0.2, .largest = 10.0};
    case Method::dop853:
      return {.exponent = 0.125, .beta = 0.0, .smallest = 0.333, .largest = 6.0};
    case Method::radau5:
    case Method::radau9:
    case Method::radau13:
      return {.exponent = 1.0 / error_order(method), .beta = 0.0, .smallest = 0.2, .largest = 8.0};
    // Another length from the same start costs a sum, and entire functions have no poles: steps may change by more.
    case Method::taylor:
      return {.exponent = 1.0 / series_degree, .beta = 0.0, .smallest = 0.05, .largest = 10.0};
  }
  __builtin_unreachable();
}

constexpr double safety = 0.9;
// An error far below the tolerance says nothing about the next step: it counts as this much.
constexpr double least_error = 1e-4;
const double least_logarithm = std::log(least_error);

/// Root mean square in units of the tolerances at x; a scale of 0 (x_i = 0, atol = 0) is replaced by the smallest one.
class WeightedNorm {
 public:
  WeightedNorm(const double* x, int n, const Tolerances& tolerances) : x_(x), n_(n), tolerances_(tolerances) {}

  template <class Component>
  double operator()(Component&& component) const {
    const auto ratio = [&](int i) {
      const double scale = tolerances_.atol + tolerances_.rtol * std::abs(x_[i]);
      return std::abs(component(i)) / std::max(scale, std::numeric_limits<double>::min());
    };
    double largest = 0.0;
    for (int i = 0; i < n_; ++i) largest = std::max(largest, ratio(i));
    if (!(largest > 0.0 && std::isfinite(largest))) return largest;
    double sum = 0.0;  // of ratios to the largest one: slopes of 1e200 have a norm, too
    for (int i = 0; i < n_; ++i) sum += std::pow(ratio(i) / largest, 2);
    return largest * std::sqrt(sum / n_);
  }

 private:
  const double* x_;
  int n_;
  Tolerances tolerances_;
};

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// f behind an Euler step of length h, shortened until it is finite there; false if that does not help.
bool slope_behind_euler_step(RightHandSide f, double t, const double* x, const double* slope, double& h,
                             std::vector<double>& slope_behind) {
  // 2^-30 of an already careful step: what is undefined even there is reported by the first step itself.
  constexpr int attempts = 10;
  std::vector<double> argument(slope_behind.size());
  for (int attempt = 0; attempt < attempts; ++attempt, h *= 0.125) {
    for (std::size_t i = 0; i < argument.size(); ++i) argument[i] = x[i] + h * slope[i];
    f(t + h, argument.data(), slope_behind.data());
    if (all_finite(slope_behind)) return true;
  }
  return false;
}

}  // namespace

StepControl::StepControl(Method method) : method_(method), previous_logarithm_(least_logarithm) {}

void StepControl::reset() { *this = StepControl(method_); }

void StepControl::restart() {
  reset();
  previous_logarithm_.reset();
}

/// previous_error^beta / error^exponent; infinite for an error of 0.
double StepControl::factor(double error_norm) {
  switch (method_) {
    case Method::dopri5: {
      const Gains gain = gains(method_);
      const double logarithm = std::log(error_norm);
      const double counts = error_norm > least_error ? logarithm : least_logarithm;
      const double factor = std::exp(gain.beta * previous_logarithm_.value_or(counts) - gain.exponent * logarithm);
      previous_logarithm_ = counts;
      return factor;
    }
    case Method::dop853:
      return 1.0 / std::sqrt(std::sqrt(std::sqrt(error_norm)));
    case Method::radau5:
      return 1.0 / std::sqrt(std::sqrt(error_norm));
    case Method::radau9:
    case Method::radau13:
      return std::pow(error_norm, -gains(method_).exponent);
    case Method::taylor:
      static_assert(series_degree == 16);
      return 1.0 / std::sqrt(std::sqrt(std::sqrt(std::sqrt(error_norm))));
  }
  __builtin_unreachable();
}

/// The error of a step of the same length may grow from step to step. Then the next one has to be shorter by as much,
/// at most 1 (the predictive controller of Gustafsson; Hairer & Wanner, (IV.8.25)). Before the first rejection steps
/// are short enough for other reasons. There it would cost a few per cent, behind it saves a tenth to a fifth.
double StepControl::growth(double error_norm) {
  const double least = std::max(error_norm, least_error);
  const double root =
      method_ == Method::dop853 ? std::sqrt(std::sqrt(std::sqrt(least))) : std::pow(least, gains(method_).exponent);
  const bool known = any_rejected_ && previous_root_ > 0.0;
  const double share = known ? std::clamp(change_ * previous_root_ / root, gains(method_).smallest, 1.0) : 1.0;
  previous_root_ = root;
  return share;
}

double StepControl::accepted(double error_norm) {
  const Gains gain = gains(method_);
  const double raw = safety * factor(error_norm);
  const double largest = last_rejected_ ? 1.0 : gain.largest;
  last_rejected_ = false;
  const bool predicts = method_ == Method::dop853 || method_ == Method::radau9 || method_ == Method::radau13;
  change_ = std::clamp(predicts ? raw * growth(error_norm) : raw, gain.smallest, largest);
  // An increase that is worth less than a factorisation.
  if (is_implicit(method_) && raw >= 1.0 && change_ >= 1.0 && change_ <= 1.2) change_ = 1.0;
  return change_;
}

double StepControl::rejected(double error_norm) {
  const Gains gain = gains(method_);
  last_rejected_ = any_rejected_ = true;
  const double factor = std::clamp(safety / std::pow(error_norm, gain.exponent), gain.smallest, safety);
  change_ *= factor;
  return factor;
}

bool StiffnessWatch::looks_stiff(const Stepper& stepper, const Tolerances& tolerances) {
  // Without suspicion a sample is enough.
  constexpr long interval = 16;
  constexpr int enough = 15;
  constexpr int acquitted = 6;
  if (suspicions_ == 0 && ++steps_ % interval != 0) return false;
  // What turns to and fro below the tolerances, as dry friction does, keeps the ratio below 1 and the state in its
  // place. Below atol all is small, and may change by its own size.
  constexpr double turns = 0.25;
  // Nearer to its limit a method is quite wrong about exp(lambda t). Where its error is small, so is that component.
  // Steps need not come to the limit: what drives the component keeps the error up.
  constexpr double near_limit = 0.65;
  const double ratio = stepper.stability_ratio(tolerances);
  if (ratio > near_limit || (ratio > turns && stepper.change({tolerances.rtol, 0.0}) < 1.0)) {
    innocent_ = 0;
    return ++suspicions_ == enough;
  }
  if (++innocent_ == acquitted) suspicions_ = innocent_ = 0;
  return false;
}

double initial_step(Method method, RightHandSide f, double t, const double* x, const double* slope, int n, double span,
                    const Tolerances& tolerances) {
  SALTUS_ASSERT(n >= 0 && span != 0.0);
  const double length = std::abs(span);
  const WeightedNorm norm(x, n, tolerances);
  const double size = norm([&](int i) { return x[i]; });
  const double speed = norm([&](int i) { return slope[i]; });
  const bool has_size = size >= 1.0;  // beyond the tolerance of 0
  // A state that would not even leave a 1e-5th of the tolerance within the span tells nothing about time. A ten times
  // larger share of the span costs rejected steps then, a ten times smaller one more steps.
  const double share = 1e-4 * length;
  const double euler = has_size && speed * length >= 1e-5 ? 0.01 * std::min(size / speed, length) : share;
  const double guess = std::isfinite(euler) && euler > 0.0 ? euler : share;

  std::vector<double> slope_behind(static_cast<std::size_t>(n));
  double trial = std::copysign(guess, span);
  if (!slope_behind_euler_step(f, t, x, slope, trial, slope_behind)) return trial;
  // Where it had to be shortened the next point beyond it is undefined: no step goes further than the Euler step.
  const double reach = std::abs(trial) < guess ? 1.0 : 100.0;
  const double bend = norm([&](int i) { return slope_behind[at(i)] - slope[i]; }) / std::abs(trial);

  // Attributes an error of amplitude (h / time)^(order + 1) to a step of length h, and allows 0.01.
  const double amplitude = has_size ? size : std::max(speed * length, bend * length * length);
  const double time = has_size ? std::min(size / speed, std::sqrt(size / bend)) : length;
  const double step = time * std::pow(0.01 / amplitude, 1.0 / error_order(method));
  if (!(step > 0.0)) return trial;  // overflow
  return std::copysign(std::min({reach * std::abs(trial), step, length}), span);
}

}  // namespace saltus::ode
