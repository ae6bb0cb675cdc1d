#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/optimal_control/advice_internal.hpp"
#include "saltus/result/impacts_at_nodes.hpp"

namespace saltus::pipeline {
namespace {

using result::Termination;

long most_elements(const OptimizeOptions& options) {
  return *std::max_element(options.elements.begin(), options.elements.end());
}

/// What to write for a solution that is nearer to the simulation.
std::string finer_grid(const OptimizeOptions& options, bool has_missed) {
  const long elements = most_elements(options);
  const auto finer = fmt::format("elements = {} or control_intervals = {}", elements + (elements + 1) / 2,
                                 2 * options.control_intervals);
  const long stages = options.element.stages;
  if (!has_missed) return fmt::format("try stages = {}, or {}", stages + 1, finer);
  return fmt::format("a switch was missed there: try {}{}", finer,
                     stages > 1 ? "" : fmt::format(", or stages = {}", stages + 1));
}

}  // namespace

std::string advice_on_bounces(const model::TimeFreezing* freezing, const OptimizeOptions& options,
                              result::Termination termination) {
  const bool is_unsolved = termination == Termination::infeasible || termination == Termination::not_converged ||
                           termination == Termination::iteration_limit;
  const bool bounces = freezing != nullptr && std::any_of(freezing->contacts.begin(), freezing->contacts.end(),
                                                          [](const auto& contact) { return contact.is_elastic; });
  const bool has_all = options.start == StartValues::simulated &&
                       *std::min_element(options.elements.begin(), options.elements.end()) >= 4;
  if (!is_unsolved || !bounces || has_all) return "";
  return "; a contact with restitution needs elements = 4 or more, and start = \"simulated\" with time_freezing.a_n "
         "near its speed divided by the length of an interval";
}

void judge(const result::Verification& verification, const OptimizeOptions& options, result::Status& status) {
  const double tolerance = options.verification_tolerance;
  if (status.termination != Termination::completed) return;
  if (verification.interval_defect <= tolerance && verification.message.empty()) return;
  status.termination = Termination::verification_failed;
  if (!verification.message.empty() && !(verification.interval_defect <= tolerance)) {
    status.message = fmt::format("an interval could not be simulated: {}", verification.message);
    if (!std::isfinite(verification.interval_defect)) return;
  }
  if (verification.interval_defect <= tolerance) {
    status.termination = Termination::completed;
    return;
  }
  status.message = fmt::format(
      "the event-driven simulation of interval {} differs by {:.3g} of the range of '{}' (verification_tolerance = "
      "{:.3g}); {}",
      verification.interval, verification.interval_defect, verification.state, tolerance,
      finer_grid(options, verification.switches_missed > 0));
}

void warn_of_path_violations(const std::vector<model::OcpConstraint>& path, model::ConstraintPoints points,
                             const result::Verification& verification, const OptimizeOptions& options,
                             const OptimizeObservers& observers) {
  for (const auto& [name, time, value, share] : verification.path_violations) {
    if (!(share > options.verification_tolerance)) continue;
    const bool is_path = std::any_of(path.begin(), path.end(), [&](const auto& row) { return row.name == name; });
    const bool has_points = is_path && points != model::ConstraintPoints::stages;
    observers.on_warning(fmt::format(
        "'{}' is violated by {:.2g} at t = {:.6g} in the simulation, between the points where it is asked for: try "
        "{}control_intervals = {} or elements = {}, or bound it by as much more",
        name, value, time, has_points ? "path_constraints_at = \"stages\", " : "", 2 * options.control_intervals,
        most_elements(options) + 1));
  }
}

void warn_of_impacts_at_nodes(const result::Result& run, const OptimizeObservers& observers) {
  const auto times = result::impacts_at_nodes(run);
  if (times.empty()) return;
  observers.on_warning(fmt::format(
      "impacts at t = {:.6g} lie at ends of control intervals: no mode sequence that fits the elements is better; "
      "compare with an element or an interval more",
      fmt::join(times, ", ")));
}

/// The certificate is one of the discretised problem, in which an interval has so many elements.
void warn_of_crowded_intervals(const discretization::OcpProblem& problem, const solver::Solution& solution,
                               const OptimizeOptions& options, const OptimizeObservers& observers) {
  const auto crowded = problem.crowded_intervals(solution.w, solution.multipliers.upper, options.mpcc.tolerance);
  if (crowded.empty()) return;
  observers.on_warning(fmt::format(
      "interval{} {} (from 0 on): another motion from there needs an element more than there is; the certificate is "
      "that of these elements: compare with elements = {}",
      crowded.size() == 1 ? "" : "s", fmt::join(crowded, ", "), most_elements(options) + 1));
}

}  // namespace saltus::pipeline
