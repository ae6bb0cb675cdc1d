#include "saltus/ode/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/contracts.hpp"
#include "saltus/ode/explicit/explicit_method_internal.hpp"
#include "saltus/ode/radau_internal.hpp"
#include "saltus/ode/series_internal.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {
namespace {

const ExplicitMethod* explicit_method(Method method, std::size_t n) {
  const bool few = 1 <= n && n <= few_states;
  switch (method) {
    case Method::dopri5:
      return &(few ? dopri5_for_few(n) : dopri5_for_any());
    case Method::dop853:
    case Method::taylor:
      return &(few ? dop853_for_few(n) : dop853_for_any());
    case Method::radau5:
    case Method::radau9:
    case Method::radau13:
      return nullptr;
  }
  __builtin_unreachable();
}

}  // namespace

int order(Method method) {
  switch (method) {
    case Method::dopri5:
      return 5;
    case Method::dop853:
      return 8;
    case Method::radau5:
      return 5;
    case Method::radau9:
      return 9;
    case Method::radau13:
      return 13;
    case Method::taylor:
      return series_degree;
  }
  __builtin_unreachable();
}

int dense_degree(Method method) {
  switch (method) {
    case Method::dopri5:
      return 4;
    case Method::dop853:
      return 7;
    case Method::radau5:
      return 3;
    case Method::radau9:
      return 5;
    case Method::radau13:
      return 7;
    case Method::taylor:
      return series_degree;
  }
  __builtin_unreachable();
}

std::string_view reason(Stages stages) {
  switch (stages) {
    case Stages::found:
      return "";
    case Stages::undefined:
      return "its iterates leave where the right-hand side is defined";
    case Stages::no_jacobian:
      return "the derivative of the right-hand side by the states is not finite";
    case Stages::singular:
      return "its linear systems are singular";
    case Stages::not_found:
      return "its iteration does not converge";
  }
  __builtin_unreachable();
}

Stepper::Stepper(Method method, int n)
    : pair_(method == Method::taylor ? Method::dop853 : method),
      n_(n),
      explicit_(explicit_method(method, static_cast<std::size_t>(n))) {
  SALTUS_ASSERT(n >= 0);
  const auto size = static_cast<std::size_t>(n);
  for (auto* vector : {&start_, &x_new_, &argument_}) vector->resize(size);
  stages_.resize(size * (explicit_ != nullptr ? explicit_->stages : 2));
  slope_new_ = size * (explicit_ != nullptr ? explicit_->last_stage : 1);
  if (n > 0) radau_ = make_radau(method, n);
  if (method == Method::taylor) series_ = std::make_unique<Series>(size);
}

Stepper::Stepper(Stepper&&) noexcept = default;
Stepper& Stepper::operator=(Stepper&&) noexcept = default;
Stepper::~Stepper() = default;

void Stepper::restart() {
  series_known_ = false;
  if (radau_) radau_->restart();
}

ExplicitStep Stepper::explicit_step() const {
  return {t_, h_, start_.size(), start_.data(), x_new_.data(), stages_.data()};
}

StagesFunction Stepper::stages_function(const StagesFunctions& functions) const {
  switch (pair_) {
    case Method::dopri5:
      return functions.dopri5;
    case Method::dop853:
      return functions.dop853;
    case Method::taylor:
    case Method::radau5:
    case Method::radau9:
    case Method::radau13:
      return nullptr;
  }
  __builtin_unreachable();
}

Attempt Stepper::attempt(RightHandSide f, double t, const double* x, const double* slope, double h,
                         const Tolerances& tolerances, const RightHandSideStages& stages) {
  const auto n = static_cast<std::size_t>(n_);
  known_ = nullptr;
  if (series_) {
    took_series_ = stages.linear != nullptr;
    series_known_ = series_known_ && took_series_ && t == t_ && std::equal(x, x + n, start_.data()) &&
                    std::equal(slope, slope + n, stages_.data());
  }
  for (std::size_t i = 0; i < n; ++i) start_[i] = x[i];
  for (std::size_t i = 0; i < n; ++i) stages_[i] = slope[i];
  t_ = t;
  h_ = h;
  if (!all_finite(stages_.data(), n)) return Attempt::undefined;
  if (took_series_) return attempt_series(f, *stages.linear, tolerances);
  if (const StagesFunction take = stages_function(stages.functions); take != nullptr) {
    const int evaluated = take(t, h, start_.data(), stages.data, stages_.data(), x_new_.data());
    evaluations_ += evaluated < 0 ? -1 - evaluated : evaluated;
    if (evaluated < 0) return Attempt::undefined;
    error_norm_ = explicit_->error_norm({t, h, n, start_.data(), x_new_.data(), stages_.data()}, tolerances);
  } else if (explicit_ != nullptr) {
    const StageWork work{f, evaluations_, x_new_.data(), stages_.data(), argument_.data()};
    // Not explicit_step(): reading back at once what has just been written costs more than a stage's sum.
    const ExplicitStep step{t, h, n, start_.data(), x_new_.data(), stages_.data()};
    if (!explicit_->take(step, work, tolerances, error_norm_)) return Attempt::undefined;
  } else if (radau_) {
    const RadauTrial trial{f, t, h, start_.data(), stages_.data(), tolerances, stages.pattern, stages.jacobian};
    const Attempt outcome = radau_->attempt(trial, x_new_.data(), stages_.data() + n, evaluations_);
    if (outcome == Attempt::undefined) return outcome;
    error_norm_ = radau_->error_norm();
  }
  if (std::isnan(error_norm_)) error_norm_ = std::numeric_limits<double>::infinity();  // overflow of both estimates
  return Attempt::finite;
}

void Stepper::follow(const DenseStep& known, double h) {
  SALTUS_ASSERT(!known.is_series() && known.size() == n_);
  known_ = &known;
  took_series_ = false;
  t_ = known.t;
  // Where times are rounded to it is the end.
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (std::abs(t_) + std::abs(known.h));
  h_ = std::abs(h - known.h) <= rounding ? known.h : h;
  const double theta = h_ / known.h;
  known.evaluate(0.0, start_.data());
  known.evaluate(theta, x_new_.data());
  error_norm_ = 0.0;
}

Attempt Stepper::attempt_series(RightHandSide f, const LinearField& linear, const Tolerances& tolerances) {
  const auto n = static_cast<std::size_t>(n_);
  if (!series_known_) series_->begin(linear, start_.data(), stages_.data(), h_);
  series_known_ = true;
  series_->take(h_, x_new_.data());
  if (!all_finite(x_new_.data(), n)) return Attempt::undefined;
  double* slope_new = stages_.data() + slope_new_;
  f(t_ + h_, x_new_.data(), slope_new);
  ++evaluations_;
  if (!all_finite(slope_new, n)) return Attempt::undefined;
  error_norm_ = series_->error_norm(x_new_.data(), tolerances);
  if (std::isnan(error_norm_)) error_norm_ = std::numeric_limits<double>::infinity();
  return Attempt::finite;
}

double Stepper::stability_ratio(const Tolerances& tolerances) const {
  if (known_ != nullptr) return 0.0;
  if (took_series_) return series_->stability_ratio(tolerances);
  return explicit_ != nullptr ? explicit_->stability_ratio(explicit_step(), tolerances) : 0.0;
}

double Stepper::stability_ratio_of_explicit() {
  return std::abs(h_) * radau_->spectral_radius() / dop853_stability_limit;
}

Stages Stepper::stages() const { return radau_ ? radau_->stages_of_attempt() : Stages::found; }

double Stepper::contraction() const { return radau_->contraction(); }

double Stepper::change(const Tolerances& tolerances) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < start_.size(); ++i) {
    largest = std::max(largest, std::abs(x_new_[i] - start_[i]) / error_scale(tolerances, start_[i], x_new_[i]));
  }
  return largest;
}

bool Stepper::bounds(double* low, double* high) const {
  if (known_ != nullptr) {
    known_->bounds(low, high);
    return true;
  }
  if (explicit_ == nullptr) return false;
  if (took_series_) {
    series_->bounds(low, high);
    return true;
  }
  explicit_->bounds(explicit_step(), low, high);
  return true;
}

bool Stepper::mean_slopes(double* low, double* high) const {
  if (explicit_ == nullptr || known_ != nullptr) return false;
  if (took_series_) {
    series_->mean_slopes(h_, low, high);
    return true;
  }
  explicit_->mean_slopes(explicit_step(), low, high);
  return true;
}

Attempt Stepper::dense(RightHandSide f, DenseStep& output) {
  if (known_ != nullptr) {
    output = *known_;
    if (h_ != known_->h) output.cut(0.0, h_ / known_->h);
    return Attempt::finite;
  }
  const auto n = static_cast<std::size_t>(n_);
  output.t = t_;
  output.h = h_;
  output.method_ = method();
  output.n_ = n_;
  output.end_.resize(n);
  std::copy_n(x_new_.begin(), n, output.end_.begin());
  if (took_series_) {
    output.coefficients_ = series_->terms();
    return Attempt::finite;
  }
  output.coefficients_.resize(n * static_cast<std::size_t>(dense_degree(method()) + 1));
  if (explicit_ != nullptr) {
    const StageWork work{f, evaluations_, x_new_.data(), stages_.data(), argument_.data()};
    const bool finite = explicit_->dense(explicit_step(), work, output.coefficients_.data()) &&
                        all_finite(output.coefficients_.data(), output.coefficients_.size());
    return finite ? Attempt::finite : Attempt::undefined;
  }
  std::copy_n(start_.begin(), n, output.coefficients_.begin());
  if (radau_) radau_->dense(output.coefficients_.data() + n);
  return Attempt::finite;
}

}  // namespace saltus::ode
