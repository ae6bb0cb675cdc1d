#include "saltus/ode/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/contracts.hpp"
#include "saltus/ode/dop853_tableau.hpp"
#include "saltus/ode/dopri5_tableau.hpp"
#include "saltus/ode/radau5_internal.hpp"
#include "saltus/ode/stage_sums_internal.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {
namespace {

std::size_t stage_count(Method method) {
  switch (method) {
    case Method::dopri5:
      return Dopri5Tableau::dense_stages;
    case Method::dop853:
      return Dop853Tableau::dense_stages;
    case Method::radau5:
      return 2;
  }
  __builtin_unreachable();
}

/// Position of f(t + h, x_new) among the stages.
std::size_t last_stage(Method method) {
  switch (method) {
    case Method::dopri5:
      return Dopri5Tableau::stages - 1;
    case Method::dop853:
      return Dop853Tableau::stages - 1;
    case Method::radau5:
      return 1;
  }
  __builtin_unreachable();
}

/// What the stages of one attempt share.
struct StageRun {
  RightHandSide f;
  double t;
  double h;
  const double* x;
  double* stages;
  std::size_t n;
  long& evaluations;
};

/// x + h times the sum of the stages with the weights of a row of the tableau.
template <class Tableau, std::size_t row>
void advance(const StageRun& run, double* __restrict result) {
  const double* x = run.x;
  const double* stages = run.stages;
  const double h = run.h;
  const std::size_t n = run.n;
  for (std::size_t i = 0; i < n; ++i) result[i] = x[i] + h * stage_sum<Tableau::a, row>(stages, n, i);
}

/// Evaluates one stage at the argument it leaves behind; false if one of both is not finite.
template <class Tableau, std::size_t row>
bool evaluate_stage(const StageRun& run, double* argument) {
  advance<Tableau, row>(run, argument);
  if (!all_finite(argument, run.n)) return false;
  double* slope = run.stages + row * run.n;
  run.f(run.t + Tableau::c[row] * run.h, argument, slope);
  ++run.evaluations;
  return all_finite(slope, run.n);
}

/// Stages first, first + 1, ...; stops at the first one that is not finite.
template <class Tableau, std::size_t first, std::size_t... offset>
bool evaluate_stages(const StageRun& run, double* argument, std::index_sequence<offset...>) {
  return (evaluate_stage<Tableau, first + offset>(run, argument) && ...);
}

/// Stages 2 to the one at the new point.
template <class Tableau>
bool take_step(const StageRun& run, double* argument, double* x_new) {
  constexpr std::size_t last = Tableau::stages - 1;
  return evaluate_stages<Tableau, 1>(run, argument, std::make_index_sequence<last - 1>{}) &&
         evaluate_stage<Tableau, last>(run, x_new);
}

/// Largest component of an embedded error estimate in units of its scale. The largest, not the mean: a state that
/// slides or rests has no error and must not buy the others a larger one. NaN if a component is (overflow), which a
/// comparison would pass over.
template <const auto& rows, std::size_t row>
double largest_error(const StageRun& run, const ErrorScale& scale, double* __restrict ratio) {
  const double* stages = run.stages;
  const double h = run.h;
  const std::size_t n = run.n;
  for (std::size_t i = 0; i < n; ++i) ratio[i] = std::abs(h * stage_sum<rows, row>(stages, n, i)) / scale(i);
  double largest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isnan(ratio[i])) return ratio[i];
    largest = std::max(largest, ratio[i]);
  }
  return largest;
}

double dopri5_error(const StageRun& run, const ErrorScale& scale, double* ratio) {
  return largest_error<Dopri5Tableau::error, 0>(run, scale, ratio);
}

/// The estimate of order 5, damped where it is small against a tenth of the one of order 3: Hairer, Norsett & Wanner,
/// (10.17) of chapter II, with the largest component in place of their mean.
double dop853_error(const StageRun& run, const ErrorScale& scale, double* ratio) {
  const double fifth = largest_error<Dop853Tableau::error, 0>(run, scale, ratio);
  const double third = largest_error<Dop853Tableau::error, 1>(run, scale, ratio);
  if (fifth == 0.0) return 0.0;
  const double ratio_of_both = 0.1 * (third / fifth);
  return fifth / std::sqrt(1.0 + ratio_of_both * ratio_of_both);
}

/// Row `row` of the dense output's own weights, times h.
template <class Tableau, std::size_t row>
void dense_row(const StageRun& run, double* __restrict result) {
  const double* stages = run.stages;
  const double h = run.h;
  const std::size_t n = run.n;
  for (std::size_t i = 0; i < n; ++i) result[i] = h * stage_sum<Tableau::dense, row>(stages, n, i);
}

template <class Tableau, std::size_t... row>
void dense_rows(const StageRun& run, double* result, std::index_sequence<row...>) {
  (dense_row<Tableau, row>(run, result + row * run.n), ...);
}

/// Coefficients 0 to 3 of the nested form: the cubic Hermite interpolant of both ends.
void hermite_coefficients(const StageRun& run, const double* x_new, const double* slope_new,
                          double* __restrict result) {
  const std::size_t n = run.n;
  for (std::size_t i = 0; i < n; ++i) {
    const double difference = x_new[i] - run.x[i];
    const double bend = run.h * run.stages[i] - difference;
    result[i] = run.x[i];
    result[n + i] = difference;
    result[2 * n + i] = bend;
    result[3 * n + i] = difference - run.h * slope_new[i] - bend;
  }
}

constexpr std::size_t hermite_count = 4;

/// h |k_last - k_before| / |x_new - x_before|, both stages at t + h: about h times the largest eigenvalue.
template <class Tableau>
double stage_stiffness(const std::vector<double>& x, const std::vector<double>& x_new, const double* stages, double h) {
  constexpr std::size_t last = Tableau::stages - 1;
  const std::size_t n = x.size();
  double slopes = 0.0, states = 0.0, size = 0.0;  // squares
  for (std::size_t i = 0; i < n; ++i) {
    const double before = x[i] + h * stage_sum<Tableau::a, last - 1>(stages, n, i);
    const double slope = stages[last * n + i] - stages[(last - 1) * n + i];
    const double state = x_new[i] - before;
    slopes += slope * slope;
    states += state * state;
    size += x_new[i] * x_new[i];
  }
  constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  return states > rounding * rounding * size ? std::abs(h) * std::sqrt(slopes / states) : 0.0;
}

template <class Tableau>
void dense_coefficients(const StageRun& run, double* result) {
  dense_rows<Tableau>(run, result, std::make_index_sequence<Tableau::dense.size()>{});
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
  }
  __builtin_unreachable();
}

Stepper::Stepper(Method method, int n) : method_(method), n_(n) {
  SALTUS_ASSERT(n >= 0);
  const auto size = static_cast<std::size_t>(n);
  for (auto* vector : {&start_, &x_new_, &argument_}) vector->resize(size);
  stages_.resize(size * stage_count(method));
  if (method == Method::radau5 && n > 0) radau_ = std::make_unique<Radau5>(n);
}

Stepper::Stepper(Stepper&&) noexcept = default;
Stepper& Stepper::operator=(Stepper&&) noexcept = default;
Stepper::~Stepper() = default;

void Stepper::restart() {
  if (radau_) radau_->restart();
}

Attempt Stepper::attempt(RightHandSide f, double t, const double* x, const double* slope, double h,
                         const Tolerances& tolerances) {
  const auto n = static_cast<std::size_t>(n_);
  std::copy_n(x, n, start_.begin());
  std::copy_n(slope, n, stages_.begin());
  t_ = t;
  h_ = h;
  const StageRun run{f, t, h, start_.data(), stages_.data(), n, evaluations_};
  const ErrorScale scale{tolerances, start_.data(), x_new_.data()};
  if (!all_finite(stages_.data(), n)) return Attempt::undefined;
  switch (method_) {
    case Method::dopri5:
      if (!take_step<Dopri5Tableau>(run, argument_.data(), x_new_.data())) return Attempt::undefined;
      error_norm_ = dopri5_error(run, scale, argument_.data());
      break;
    case Method::dop853:
      if (!take_step<Dop853Tableau>(run, argument_.data(), x_new_.data())) return Attempt::undefined;
      error_norm_ = dop853_error(run, scale, argument_.data());
      break;
    case Method::radau5:
      if (n == 0) break;
      if (radau_->attempt({f, t, h, start_.data(), stages_.data(), tolerances}, x_new_.data(), stages_.data() + n,
                          evaluations_) == Attempt::undefined) {
        return Attempt::undefined;
      }
      error_norm_ = radau_->error_norm();
      break;
  }
  if (n == 0) error_norm_ = 0.0;
  if (std::isnan(error_norm_)) error_norm_ = std::numeric_limits<double>::infinity();  // overflow of both estimates
  return Attempt::finite;
}

const double* Stepper::slope_new() const { return stages_.data() + last_stage(method_) * static_cast<std::size_t>(n_); }

/// Limits of the codes DOPRI5 and DOP853 of Hairer & Wanner.
double Stepper::stability_ratio() const {
  switch (method_) {
    case Method::dopri5:
      return stage_stiffness<Dopri5Tableau>(start_, x_new_, stages_.data(), h_) / 3.25;
    case Method::dop853:
      return stage_stiffness<Dop853Tableau>(start_, x_new_, stages_.data(), h_) / 6.1;
    case Method::radau5:
      return 0.0;
  }
  __builtin_unreachable();
}

// With the chord's slope d = (x_new - x) / h, R = h max |k_i - d| over the stages and p the dense output, p' - d is a
// polynomial of mean 0 on the step. dopri5: its coefficients 2 to 4 are known. dop853: p' has degree 6, and what p' - d
// is at most at the nodes of stages 1, 4, 8 to 12 (0, 0.118, 0.308, 0.651, 0.6, 0.857, 1) bounds |p - chord| by 0.4903
// times as much, by interpolation there; the stages' slopes are those of p up to terms of higher order in h, and the
// bound used is R itself, twice that, over stages 1 and 4 to 12.
bool Stepper::bounds(double* low, double* high) const {
  const auto n = static_cast<std::size_t>(n_);
  const double* stages = stages_.data();
  const double* start = start_.data();
  const double* end = x_new_.data();
  switch (method_) {
    case Method::dopri5:
      for (std::size_t i = 0; i < n; ++i) {
        const double difference = end[i] - start[i];
        const double bend = h_ * stages[i] - difference;
        const double twist = difference - h_ * stages[(Dopri5Tableau::stages - 1) * n + i] - bend;
        const double width = std::abs(bend) / 4.0 + std::abs(twist) * (4.0 / 27.0) +
                             std::abs(h_ * stage_sum<Dopri5Tableau::dense, 0>(stages, n, i)) / 16.0;
        low[i] = std::min(start[i], end[i]) - width;
        high[i] = std::max(start[i], end[i]) + width;
      }
      return true;
    case Method::dop853:
      for (std::size_t i = 0; i < n; ++i) {
        const double difference = end[i] - start[i];
        double width = std::abs(h_ * stages[i] - difference);
        for (std::size_t stage = 3; stage < Dop853Tableau::stages; ++stage) {
          width = std::max(width, std::abs(h_ * stages[stage * n + i] - difference));
        }
        low[i] = std::min(start[i], end[i]) - width;
        high[i] = std::max(start[i], end[i]) + width;
      }
      return true;
    case Method::radau5:
      return false;
  }
  __builtin_unreachable();
}

Attempt Stepper::dense(RightHandSide f, DenseStep& output) {
  const auto n = static_cast<std::size_t>(n_);
  const StageRun run{f, t_, h_, start_.data(), stages_.data(), n, evaluations_};
  output.t = t_;
  output.h = h_;
  output.method_ = method_;
  output.n_ = n_;
  output.end_.resize(n);
  output.coefficients_.resize(n * static_cast<std::size_t>(dense_degree(method_) + 1));
  std::copy_n(x_new_.begin(), n, output.end_.begin());
  if (method_ == Method::radau5) {
    std::copy_n(start_.begin(), n, output.coefficients_.begin());
    if (radau_) radau_->dense(output.coefficients_.data() + n);
    return Attempt::finite;
  }
  hermite_coefficients(run, x_new_.data(), slope_new(), output.coefficients_.data());
  double* upper = output.coefficients_.data() + hermite_count * n;
  switch (method_) {
    case Method::dopri5:
      dense_coefficients<Dopri5Tableau>(run, upper);
      return Attempt::finite;
    case Method::dop853: {
      constexpr std::size_t first = Dop853Tableau::stages;
      constexpr auto extra = std::make_index_sequence<Dop853Tableau::dense_stages - first>{};
      if (!evaluate_stages<Dop853Tableau, first>(run, argument_.data(), extra)) return Attempt::undefined;
      dense_coefficients<Dop853Tableau>(run, upper);
      return Attempt::finite;
    }
    case Method::radau5:
      break;  // above
  }
  __builtin_unreachable();
}

}  // namespace saltus::ode
