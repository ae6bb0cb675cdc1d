#include "saltus/event_integrator/steps/local_steps.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"

namespace saltus::event_integrator {
namespace {

/// Of fewer states all are integrated as fast.
constexpr std::size_t fewest_states = 64;
/// Rings of states around those that a selection moves.
constexpr int most_rings = 3;

/// Of models and options whose switches are ordinary (Run::has_ordinary_switches).
bool applies(const IntegrationOptions& options, const evaluation::ModelKernel& kernel) {
  const bool nested = options.method == ode::Method::dopri5 || options.method == ode::Method::dop853;
  return options.local_steps && nested && at(kernel.states()) >= fewest_states;
}

}  // namespace

LocalSteps::LocalSteps(const IntegrationOptions& options, const evaluation::ModelKernel& kernel,
                       const StepTolerances& tolerances)
    : method_(options.method), kernel_(kernel), tolerances_(tolerances), applies_(applies(options, kernel)) {}

const LocalSteps::Part* LocalSteps::part_of(int surface, int rings) {
  if (!applies_) return nullptr;
  if (!parts_) {
    parts_.emplace(*kernel_.compiled());
    x_.resize(at(kernel_.states()));
    slope_.resize(x_.size());
  }
  return parts_->of(surface, rings);
}

bool LocalSteps::slope_behind(int surface, double t, const double* x, const evaluation::FieldConstants& behind,
                              const std::vector<double>& before, std::vector<double>& slope) {
  const Part* part = part_of(surface, 0);
  if (part == nullptr) return false;
  slope = before;
  (*parts_)(*part, t, x, behind, slope.data());
  return true;
}

/// One step, from the beginning of what is known to its end, which is cut where the error asks for it.
bool LocalSteps::integrate(const Part& part, const std::vector<double>& x,
                           const evaluation::FieldConstants& constants) {
  const std::size_t n = part.rows.size();
  auto& stepper = steppers_.try_emplace(n, method_, static_cast<int>(n)).first->second;
  const auto f = [&](double t, const double* y, double* slope) {
    const double theta = std::clamp((t - known_.t) / known_.h, 0.0, 1.0);
    for (const std::size_t input : part.inputs) x_[input] = known_.value(input, theta);
    for (std::size_t i = 0; i < n; ++i) x_[part.rows[i]] = y[i];
    (*parts_)(part, t, x_.data(), constants, slope_.data());
    for (std::size_t i = 0; i < n; ++i) slope[i] = slope_[part.rows[i]];
  };
  start_.resize(n);
  start_slope_.resize(n);
  for (std::size_t i = 0; i < n; ++i) start_[i] = x[part.rows[i]];
  f(known_.t, start_.data(), start_slope_.data());
  constexpr int attempts = 4;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const auto outcome = stepper.attempt(f, known_.t, start_.data(), start_slope_.data(), known_.h, tolerances_.step());
    if (outcome == ode::Attempt::undefined) return false;
    const double error = stepper.error_norm();
    if (error <= 1.0) return stepper.dense(f, part_) == ode::Attempt::finite;
    constexpr double least = 0.1, safety = 0.8;
    known_.cut(0.0, std::max(least, safety * std::pow(error, -1.0 / ode::order(method_))));
  }
  return false;
}

/// Whether states outside of the part would move by more than the tolerance: their neighbours in it have.
bool LocalSteps::is_felt(const Part& part) const {
  const auto& [rtol, atol] = tolerances_.step();
  return std::any_of(part.border.begin(), part.border.end(), [&, rtol = rtol, atol = atol](std::size_t state) {
    const auto place = std::lower_bound(part.rows.begin(), part.rows.end(), state) - part.rows.begin();
    const double before = known_.end(state), now = part_.end(static_cast<std::size_t>(place));
    return !(std::abs(now - before) <= atol + rtol * std::max(std::abs(now), std::abs(before)));
  });
}

const ode::DenseStep* LocalSteps::behind(int surface, double t, const std::vector<double>& x,
                                         const ode::DenseStep& step, double error,
                                         const evaluation::FieldConstants& behind) {
  if (part_of(surface, 0) == nullptr) return nullptr;
  const double end = step.t + step.h;
  // What is left of the step must be more than the rounding of its times.
  constexpr double resolved = 1e3 * rounding_unit;
  if (!(end - t > resolved * (std::abs(t) + std::abs(step.h)))) return nullptr;
  if (step.t != known_.t) {  // otherwise it is the rest of a step already
    constexpr double safety = 0.9, smallest = 0.2, largest = 5.0;
    next_length_ = step.h * std::clamp(safety * std::pow(error, -1.0 / ode::order(method_)), smallest, largest);
  }
  known_ = step;
  known_.cut(std::max(0.0, (t - step.t) / step.h), 1.0);
  known_.t = t;
  known_.h = end - t;
  for (int rings = 0; rings <= most_rings; ++rings) {
    const Part* part = part_of(surface, rings);
    if (part == nullptr || !integrate(*part, x, behind)) return nullptr;
    if (is_felt(*part)) continue;
    for (std::size_t i = 0; i < part->rows.size(); ++i) known_.replace(part->rows[i], part_, i);
    return &known_;
  }
  return nullptr;
}

}  // namespace saltus::event_integrator
