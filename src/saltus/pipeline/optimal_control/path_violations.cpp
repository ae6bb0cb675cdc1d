#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/path_violations_internal.hpp"

namespace saltus::pipeline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Of the range: simulations are accurate to 1e-10.
constexpr double rounding = 1e-9;

}  // namespace

double worse(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? std::numeric_limits<double>::quiet_NaN() : std::max(a, b);
}

double violation(double value, double lower, double upper) { return worse(worse(lower - value, value - upper), 0.0); }

double scale_of(double range, double lower, double upper) {
  double scale = std::max(range, 1e-6);
  for (const double bound : {lower, upper}) {
    if (std::isfinite(bound)) scale = std::max(scale, 1e-3 * std::abs(bound));
  }
  return scale;
}

PathViolations::PathViolations(const std::vector<model::OcpConstraint>& path, const std::vector<StateBounds>& states,
                               std::optional<std::size_t> clock)
    : clock_(clock) {
  const auto watch = [&](const std::string& name, bool is_state, std::size_t column, double lower, double upper) {
    if (lower == -infinity && upper == infinity) return;
    watched_.push_back({name, is_state, column, lower, upper, 0.0, 0.0, infinity, -infinity});
  };
  for (const auto& constraint : path) {
    if (constraint.norm != model::ConstraintNorm::hard || constraint.is_slack) continue;
    watch(constraint.name, false, at(constraint.output), constraint.lower, constraint.upper);
  }
  for (std::size_t i = 0; i < states.size(); ++i) watch(states[i].name, true, i, states[i].lower, states[i].upper);
}

void PathViolations::include(const event_integrator::Integration& run, double until) {
  const auto& rows = run.trajectory;
  for (std::size_t r = 0; r < rows.t.size(); ++r) {
    for (auto& one : watched_) {
      const double value = one.is_state ? rows.x[r][one.column] : rows.outputs[r][one.column];
      one.least = std::min(one.least, value);
      one.most = std::max(one.most, value);
      const double worst = worse(one.value, violation(value, one.lower, one.upper));
      if (!(worst > one.value) && !std::isnan(worst)) continue;
      one.value = worst;
      one.time = clock_ ? rows.x[r][*clock_] : rows.t[r];
    }
    if (rows.t[r] >= until) break;  // a second row at the end is behind the jump of the controls
  }
}

double PathViolations::largest() const {
  double largest = 0.0;
  for (const auto& one : watched_) largest = worse(largest, one.value);
  return largest;
}

std::vector<result::PathViolation> PathViolations::list() const {
  std::vector<result::PathViolation> list;
  for (const auto& one : watched_) {
    const double share = one.value / scale_of(one.most - one.least, one.lower, one.upper);
    if (share > rounding) list.push_back({one.name, one.time, one.value, share});
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  return list;
}

}  // namespace saltus::pipeline
