#include "saltus/event_integrator/steps/local_steps.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"

namespace saltus::event_integrator {
namespace {

/// Rings of states around those that a selection moves.
constexpr int most_rings = 8;

/// Of models and options whose switches are ordinary (Run::has_ordinary_switches).
bool is_wanted(const IntegrationOptions& options) {
  return options.local_steps && (options.method == ode::Method::dopri5 || options.method == ode::Method::dop853);
}

}  // namespace

LocalSteps::LocalSteps(const IntegrationOptions& options, const evaluation::ModelKernel& kernel,
                       const StepTolerances& tolerances)
    : method_(options.method), kernel_(kernel), tolerances_(tolerances), wanted_(is_wanted(options)), field_(kernel) {}

bool LocalSteps::applies() { return wanted_ && field_.is_known(); }

void LocalSteps::renew_slope(int surface, double t, const double* x, const std::vector<double>& alpha,
                             std::vector<double>& slope) const {
  field_.each_state_of(surface,
                       [&](std::size_t state) { slope[state] = kernel_.field_row(state, t, x, alpha.data()); });
}

/// One step, from the beginning of what is known to its end, which is cut where the error asks for it.
bool LocalSteps::integrate(const std::vector<double>& x) {
  const auto& rows = field_.rows();
  const std::size_t n = rows.size();
  auto& stepper = steppers_.try_emplace(n, method_, static_cast<int>(n)).first->second;
  const auto f = [&](double t, const double* y, double* slope) { field_(known_, t, y, slope); };
  start_.resize(n);
  start_slope_.resize(n);
  for (std::size_t i = 0; i < n; ++i) start_[i] = x[rows[i]];
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

/// Whether states outside of the part would move by more than a share of the tolerance: their neighbours in it have.
bool LocalSteps::is_felt() const {
  // Many switches follow each other in the time of one step.
  constexpr double share = 0.1;
  const double rtol = share * tolerances_.step().rtol, atol = share * tolerances_.step().atol;
  const auto& rows = field_.rows();
  return std::any_of(field_.border().begin(), field_.border().end(), [&](std::size_t state) {
    const auto place = std::lower_bound(rows.begin(), rows.end(), state) - rows.begin();
    const double before = known_.end(state), now = part_.end(static_cast<std::size_t>(place));
    return !(std::abs(now - before) <= atol + rtol * std::max(std::abs(now), std::abs(before)));
  });
}

const ode::DenseStep* LocalSteps::behind(int surface, double t, const std::vector<double>& x,
                                         const ode::DenseStep& step, double error, const ModeState& mode) {
  if (!applies() || !field_.begin(surface, mode)) return nullptr;
  const double begin = step.t, length = step.h, end = begin + length;
  // What is left of the step must be more than the rounding of its times.
  constexpr double resolved = 1e3 * rounding_unit;
  if (!(end - t > resolved * (std::abs(t) + std::abs(length)))) return nullptr;
  if (&step != &known_) {  // otherwise it is the rest of a step already
    constexpr double safety = 0.9, smallest = 0.2, largest = 5.0;
    next_length_ = length * std::clamp(safety * std::pow(error, -1.0 / ode::order(method_)), smallest, largest);
    known_ = step;
  }
  known_.cut(std::max(0.0, (t - begin) / length), 1.0);
  known_.t = t;
  known_.h = end - t;
  for (int rings = 0; rings <= most_rings; ++rings) {
    if ((rings > 0 && !field_.grow()) || !integrate(x)) return nullptr;
    if (is_felt()) continue;
    for (std::size_t i = 0; i < field_.rows().size(); ++i) known_.replace(field_.rows()[i], part_, i);
    return &known_;
  }
  return nullptr;
}

}  // namespace saltus::event_integrator
