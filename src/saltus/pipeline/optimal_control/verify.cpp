#include "saltus/pipeline/optimal_control/verify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/bodies/gaps.hpp"
#include "saltus/pipeline/optimal_control/path_violations_internal.hpp"
#include "saltus/pipeline/optimal_control/resimulation_internal.hpp"
#include "saltus/pipeline/optimal_control/switch_comparison_internal.hpp"

namespace saltus::pipeline {
namespace {

using event_integrator::Integration;
using model::Ocp;
using model::OcpConstraint;
using result::Termination;
using result::Verification;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
/// Lengths of an interval: a switch so near to its end may be found in the next one. The states say how much it
/// matters.
constexpr double end_tolerance = 1e-3;
/// Rows of the open loop that are kept.
constexpr std::size_t most_kept_rows = 2000;

std::vector<StateBounds> state_bounds(const Ocp& ocp) {
  const auto& system = ocp.system;
  std::vector<StateBounds> bounds;
  for (std::size_t i = 0; i < system.state_names.size(); ++i) {
    bounds.push_back({system.state_names[i], system.state_lower[i], system.state_upper[i]});
  }
  return bounds;
}

/// The state that is physical time.
std::optional<std::size_t> clock_of(const Ocp& ocp) {
  if (!ocp.clock) return std::nullopt;
  return at(ocp.clock->state);
}

double violation_of(const std::vector<OcpConstraint>& constraints, const std::vector<double>& outputs) {
  double worst = 0.0;
  for (const auto& constraint : constraints) {
    if (constraint.norm != model::ConstraintNorm::hard) continue;
    worst = worse(worst, violation(outputs[at(constraint.output)], constraint.lower, constraint.upper));
  }
  return worst;
}

/// What errors of a state are divided by: its range, at least 1e-3 of its bound and 1e-6. Of bodies that touch, a
/// position or velocity may be held, and has no range of its own: then at least 1e-4 of the largest one of its kind.
class Scales {
 public:
  Scales(const model::System& system, const OptimizedPath& path)
      : system_(system), low_(path.state_min), high_(path.state_max), kind_(low_.size(), nullptr) {
    for (const auto* kind : {&system.contacts.positions, &system.contacts.velocities}) {
      for (const int state : *kind) kind_[at(state)] = kind;
    }
  }

  void include(const Integration& run) {
    for (const auto& x : run.trajectory.x) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(x[i])) continue;
        low_[i] = std::min(low_[i], x[i]);
        high_[i] = std::max(high_[i], x[i]);
      }
    }
  }

  [[nodiscard]] double of(std::size_t state) const {
    double scale = scale_of(range(state), system_.state_lower[state], system_.state_upper[state]);
    if (const auto* kind = kind_[state]) {
      for (const int other : *kind) scale = std::max(scale, 1e-4 * range(at(other)));
    }
    return scale;
  }

  [[nodiscard]] std::vector<double> all() const {
    std::vector<double> scales;
    for (std::size_t i = 0; i < low_.size(); ++i) scales.push_back(of(i));
    return scales;
  }

 private:
  [[nodiscard]] double range(std::size_t state) const { return high_[state] - low_[state]; }

  const model::System& system_;
  std::vector<double> low_, high_;
  std::vector<const std::vector<int>*> kind_;  ///< positions, velocities, or neither
};

/// Everything but the open loop.
class IntervalChecks {
 public:
  IntervalChecks(const Ocp& ocp, const OptimizedPath& path, Verification& verification)
      : ocp_(ocp),
        path_(path),
        verification_(verification),
        scales_(ocp.system, path),
        violations_(ocp.path, state_bounds(ocp), clock_of(ocp)) {
    if (!ocp.system.contacts.empty()) {
      gaps_.emplace(ocp.system, path.parameters);
      verification.penetration.emplace();
    }
    for (const auto& column : ocp.system.columns) {
      is_listed_.push_back(ocp.system.switching[at(column.function)].role == model::SwitchingRole::listed);
    }
  }

  /// @return false: interrupted
  [[nodiscard]] bool simulate(Resimulation& resimulation, const std::function<bool()>& is_interrupted) {
    for (std::size_t k = 0; k < path_.controls.size(); ++k) {
      const auto is_near = [&](const std::vector<double>& end) {
        return difference_at_end(k, end).first <= verification_.tolerance;
      };
      const auto interval = resimulation.interval(k, is_near, is_interrupted);
      if (interval.run.status.termination == Termination::stopped_by_user) return false;
      switches_.push_back(switches_of(interval.run.events, is_listed_));
      if (interval.was_chosen) chosen_.push_back(k);
      ends_.push_back({interval.run.final.x, interval.moved});
      if (!interval.is_complete) {
        note_failure(k, interval.run.status);
        continue;
      }
      scales_.include(interval.run);
      if (gaps_) {
        double& deepest = verification_.penetration->simulation;
        deepest = std::max(deepest, gaps_->depth(interval.run.trajectory));
      }
      violations_.include(interval.run, path_.times[k + 1]);
    }
    return true;
  }

  void compare() {
    find_defect();
    verification_.path_violation = failures_ > 0 ? not_known : violations_.largest();
    verification_.path_violations = violations_.list();
    const auto switches =
        compare_switches(path_.times, switches_, switches_of(path_.events, is_listed_), end_tolerance);
    verification_.switch_time_error = switches.time_error;
    verification_.switches_missed = switches.missed;
    verification_.switches_extra = switches.extra;
    if (failures_ > 1) verification_.message += fmt::format(" ({} intervals cannot be simulated)", failures_);
    if (chosen_.empty()) return;
    add(fmt::format("the solution is not unique in interval{} {}: the mode of the optimised trajectory is compared",
                    chosen_.size() == 1 ? "" : "s", fmt::join(chosen_, ", ")));
  }

  [[nodiscard]] const Scales& scales() const { return scales_; }

  /// Of an end of interval k and that of the solution, relative to the ranges of the states; of which state.
  [[nodiscard]] std::pair<double, std::size_t> difference_at_end(std::size_t k, const std::vector<double>& end) const {
    const auto worst = largest_difference(end, path_.nodes[k + 1]);
    // A jump at the node itself is before it or behind it by a rounding.
    return path_.ends.empty() ? worst : std::min(worst, largest_difference(end, path_.ends[k]));
  }

 private:
  void add(const std::string& text) { verification_.message += (verification_.message.empty() ? "" : "; ") + text; }

  void note_failure(std::size_t k, const result::Status& status) {
    if (++failures_ > 1) return;
    verification_.interval = static_cast<int>(k);
    add(fmt::format("interval {} cannot be simulated: {}{}{}", k, result::name(status.termination),
                    status.message.empty() ? "" : ": ", status.message));
  }

  void find_defect() {
    if (failures_ > 0) {
      verification_.interval_defect = not_known;
      return;
    }
    for (std::size_t k = 0; k < ends_.size(); ++k) {
      const auto& [end, moved] = ends_[k];
      auto worst = difference_at_end(k, end);
      if (!moved.empty()) worst = std::max(worst, largest_difference(moved, std::vector<double>(moved.size(), 0.0)));
      if (verification_.interval >= 0 && !(worst.first > verification_.interval_defect)) continue;
      verification_.interval_defect = worst.first;
      verification_.interval = static_cast<int>(k);
      verification_.state = ocp_.system.state_names[worst.second];
    }
  }

  /// Relative to the ranges of the states; of which one.
  [[nodiscard]] std::pair<double, std::size_t> largest_difference(const std::vector<double>& a,
                                                                  const std::vector<double>& b) const {
    std::pair<double, std::size_t> worst{-1.0, 0};
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double difference = std::abs(a[i] - b[i]) / scales_.of(i);
      if (difference > worst.first || std::isnan(difference)) worst = {difference, i};
    }
    return worst;
  }

  const Ocp& ocp_;
  const OptimizedPath& path_;
  Verification& verification_;
  Scales scales_;
  PathViolations violations_;
  struct End {
    std::vector<double> x, moved;
  };
  std::vector<End> ends_;
  std::vector<std::vector<Switch>> switches_;
  std::vector<bool> is_listed_;
  std::vector<std::size_t> chosen_;
  std::optional<Gaps> gaps_;
  int failures_ = 0;
};

/// At most so many rows, of equal distance in number; first and last ones stay.
void keep_rows(const result::Trajectory& rows, result::OpenLoop& open_loop) {
  const std::size_t n = rows.t.size(), kept = std::min(n, most_kept_rows);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::size_t row = kept < 2 ? i : i * (n - 1) / (kept - 1);
    open_loop.t.push_back(rows.t[row]);
    open_loop.x.push_back(rows.x[row]);
  }
}

result::OpenLoop open_loop_of(const Ocp& ocp, const OptimizedPath& path, const Scales& scales,
                              Resimulation::Segment segment) {
  auto& run = segment.run;
  result::OpenLoop open_loop;
  open_loop.termination = run.status.termination;
  open_loop.message = run.status.message;
  open_loop.end_state_error = open_loop.terminal_violation = not_known;
  if (segment.is_complete) {
    open_loop.end_state_error = 0.0;
    for (std::size_t i = 0; i < run.final.x.size(); ++i) {
      const double error = std::abs(run.final.x[i] - path.nodes.back()[i]) / scales.of(i);
      open_loop.end_state_error = worse(open_loop.end_state_error, error);
    }
    open_loop.terminal_violation = violation_of(ocp.terminal, run.final.outputs);
  }
  keep_rows(run.trajectory, open_loop);
  return open_loop;
}

/// What of the plant is not as in the model.
std::vector<std::pair<std::string, double>> differing_values(const Ocp& ocp) {
  std::vector<std::pair<std::string, double>> list;
  if (!ocp.plant) return list;
  const auto compare = [&](const auto& names, const auto& values, const auto& planned, const auto& is_shown) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (values[i] != planned[i] && is_shown(i)) list.emplace_back(names[i], values[i]);
    }
  };
  compare(ocp.plant->parameter_names, ocp.plant->parameter_values, ocp.system.parameter_values,
          [&](std::size_t i) { return !ocp.is_initial_value(i); });
  compare(ocp.plant->state_names, ocp.plant->initial_state, ocp.system.initial_state, [](std::size_t) { return true; });
  return list;
}

}  // namespace

Expected<Verification> verify(const Ocp& ocp, const OptimizedPath& path, const VerificationWanted& wanted,
                              const std::function<bool()>& is_interrupted) {
  auto resimulation = Resimulation::make(ocp.system, path);
  if (!resimulation) return tl::unexpected(resimulation.error());
  Verification verification;
  verification.tolerance = wanted.tolerance;
  IntervalChecks checks(ocp, path, verification);
  if (!checks.simulate(*resimulation, is_interrupted)) {
    verification.interval_defect = verification.path_violation = not_known;
    auto& open_loop = verification.open_loop;
    open_loop.end_state_error = open_loop.terminal_violation = open_loop.amplification = not_known;
    open_loop.termination = Termination::stopped_by_user;
    verification.message = "stopped before all intervals were simulated";
    return verification;
  }
  checks.compare();
  const auto is_near_end = [&](const std::vector<double>& end) {
    return checks.difference_at_end(path.controls.size() - 1, end).first <= wanted.tolerance;
  };
  verification.open_loop =
      open_loop_of(ocp, path, checks.scales(), resimulation->open_loop(is_near_end, is_interrupted));
  verification.open_loop.amplification = resimulation->amplification(checks.scales().all(), is_interrupted);
  if (wanted.gains.empty()) return verification;
  auto closed_loop = simulate_closed_loop(ocp, path, wanted.gains, is_interrupted);
  if (!closed_loop) return tl::unexpected(closed_loop.error());
  verification.closed_loop = open_loop_of(ocp, path, checks.scales(), std::move(*closed_loop));
  verification.closed_loop->amplification = not_known;
  verification.closed_loop->gains = used_gains(path, wanted.gains);
  verification.plant = differing_values(ocp);
  return verification;
}

}  // namespace saltus::pipeline
