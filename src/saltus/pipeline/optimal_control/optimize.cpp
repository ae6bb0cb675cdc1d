#include "saltus/pipeline/optimal_control/optimize.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/bodies/gaps.hpp"
#include "saltus/pipeline/optimal_control/advice_internal.hpp"
#include "saltus/pipeline/optimal_control/optimized_run.hpp"
#include "saltus/pipeline/optimal_control/optimum_result_internal.hpp"
#include "saltus/pipeline/optimal_control/solve_ocp_internal.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"
#include "saltus/pipeline/options/element_choices_internal.hpp"
#include "saltus/pipeline/options/number_list_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_path_internal.hpp"
#include "saltus/solver/feedback.hpp"

namespace saltus::pipeline {
namespace {

using result::Termination;

/// States by the range that they have in the plan, controls by the width of their bounds; what does not move, or has
/// none, may be off by anything.
std::optional<solver::TrackingScales> tracking_scales(const model::Ocp& ocp, const OptimizeOptions& options,
                                                      const OptimizedPath& path) {
  if (options.feedback != Feedback::tracking) return std::nullopt;
  const auto widths = [](const std::vector<double>& low, const std::vector<double>& high) {
    std::vector<double> list;
    for (std::size_t i = 0; i < low.size(); ++i) list.push_back(high[i] > low[i] ? high[i] - low[i] : INFINITY);
    return list;
  };
  return solver::TrackingScales{widths(path.state_min, path.state_max),
                                widths(ocp.system.control_lower, ocp.system.control_upper)};
}

/// How deep bodies are in each other at the nodes and stages.
double solution_depth(const model::Ocp& ocp, const discretization::OcpSolution& solution) {
  Gaps gaps(*ocp.physical, solution.parameters);
  const auto clock = at(ocp.system.freezing->clock);
  const auto depth = [&](const std::vector<double>& x) { return gaps.depth(x[clock], x); };
  double deepest = depth(solution.initial_state);
  for (const auto& interval : solution.elements) {
    for (const auto& element : interval) {
      for (linalg::Index m = 0; m < element.states.cols(); ++m) {
        deepest = std::max(deepest, depth(list_of(element.states.col(m))));
      }
      deepest = std::max(deepest, depth(list_of(element.end)));
    }
  }
  return deepest;
}

/// Frozen systems stand for others, which the event engine simulates.
Expected<result::Verification> judged_by_events(const model::Ocp& ocp, const OptimizedPath& path,
                                                const result::Result& run, const OptimizeOptions& options,
                                                std::vector<linalg::Matrix> gains, PhysicalBodies* bodies,
                                                const OptimizeObservers& observers) {
  const VerificationWanted wanted{options.verification_tolerance, std::move(gains)};
  if (bodies == nullptr) return verify(ocp, path, wanted, observers.is_interrupted);
  return verify(physical_ocp(ocp), physical_path(ocp, *bodies, path, run), wanted, observers.is_interrupted);
}

/// Observers whose warnings the status of an optimum has, too: it says what the certificate leaves open.
OptimizeObservers noting(const OptimizeObservers& observers, result::Status& status) {
  auto noted = observers;
  noted.on_warning = [&observers, &status](const std::string& warning) {
    if (is_done(status.termination)) status.message += (status.message.empty() ? "" : "; ") + warning;
    observers.on_warning(warning);
  };
  return noted;
}

/// A result is started from with the elements that it has.
void keep_added_elements(const std::vector<int>& elements, const OptimizeObservers& observers,
                         OptimizeOptions& options) {
  options.elements.assign(elements.begin(), elements.end());
  observers.on_warning(fmt::format(
      "intervals have more elements than asked for, as another motion needs them and is better: elements = [{}]",
      fmt::join(elements, ", ")));
}

Expected<result::Result> judged_result(const model::Ocp& ocp, const OptimizeOptions& asked,
                                       const OptimizeObservers& observers, const SolvedOcp& solved) {
  auto& problem = *solved.stated.problem;
  const auto& solution = solved.solution;
  OptimizeOptions options = asked;
  if (solved.has_more_elements) keep_added_elements(solved.stated.elements, observers, options);

  const auto read = problem.read(solution.w);
  auto run = optimized_run(ocp, read, reformulation_options(options.element), solved.stated.tableau);
  if (!run) return tl::unexpected(run.error());
  auto result = optimum_result(ocp, options, solved, read, *run);
  std::unique_ptr<PhysicalBodies> bodies;
  if (ocp.physical) {
    auto made = PhysicalBodies::make(ocp, run->path.parameters);
    if (!made) return tl::unexpected(made.error());
    bodies = std::move(*made);
    add_impulses(*bodies, result);
  }
  const auto noted = noting(observers, result.status);
  warn_of_impacts_at_nodes(result, noted);
  warn_of_crowded_intervals(problem, solution, options, noted);
  if (result.status.termination == Termination::stopped_by_user || !solution.w.all_finite()) return result;
  std::vector<linalg::Matrix> gains;
  if (options.closed_loop.value_or(ocp.plant || !result.contacts.empty())) {
    gains = solver::feedback_gains(problem, solution, static_cast<int>(ocp.system.control_names.size()),
                                   static_cast<int>(result.states.size()), tracking_scales(ocp, options, run->path));
  }
  auto verification = judged_by_events(ocp, run->path, result, options, std::move(gains), bodies.get(), observers);
  if (!verification) return tl::unexpected(verification.error());
  judge(*verification, options, result.status);
  warn_of_path_violations(ocp.path, ocp.path_at, *verification, options, observers);
  if (verification->penetration) verification->penetration->solution = solution_depth(ocp, read);
  result.optimization->verification = std::move(*verification);
  return result;
}

/// The interval in which the motion itself is farthest from the solution, where that is too far.
std::optional<int> differing_interval(const result::Result& result) {
  if (result.status.termination != Termination::verification_failed) return std::nullopt;
  const auto& verification = *result.optimization->verification;
  return std::isfinite(verification.interval_defect) ? std::optional(verification.interval) : std::nullopt;
}

/// Of the objective, relative: what costs more is another motion.
constexpr double worth_a_distance = 0.1;

/// Warnings of a result, to be told if it is the last one.
struct Judged {
  result::Result result;
  std::vector<std::string> warnings;
};

Expected<Judged> judged(const model::Ocp& ocp, const OptimizeOptions& asked, const OptimizeObservers& observers,
                        const SolvedOcp& solved) {
  std::vector<std::string> warnings;
  auto later = observers;
  later.on_warning = [&](const std::string& warning) { warnings.push_back(warning); };
  auto result = judged_result(ocp, asked, later, solved);
  if (!result) return tl::unexpected(result.error());
  return Judged{std::move(*result), std::move(warnings)};
}

}  // namespace

Expected<result::Result> optimize(const model::Ocp& ocp, const OptimizeOptions& asked,
                                  const OptimizeObservers& observers) {
  const SymbolicLock lock;  // problems are made, and dropped, while it runs
  const Stopwatch whole;
  if (auto error = model::find_stale(ocp.system)) return tl::unexpected(*error);
  auto solved = solve_ocp(ocp, asked, observers);
  if (!solved) return tl::unexpected(solved.error());
  auto found = judged(ocp, asked, observers, *solved);
  if (!found) return tl::unexpected(found.error());
  const double objective = found->result.optimization->objective;
  const double most = objective + worth_a_distance * std::abs(objective);
  auto missed_in = differing_interval(found->result);
  while (missed_in && !ocp.physical) {
    OptimizeOptions rest = asked;
    rest.mpcc.time_limit = solver::time_left(asked.mpcc, whole.seconds());
    if (!keep_off_touched(rest, observers, *missed_in, *solved)) break;
    auto next = judged(ocp, asked, observers, *solved);
    if (!next) return tl::unexpected(next.error());
    if (!(next->result.optimization->objective <= most)) break;
    missed_in = differing_interval(next->result);
    if (!is_done(next->result.status.termination)) continue;
    next->warnings.push_back(fmt::format(
        "what the solution would only touch it is kept off by up to {:.2g}, so that its motion does not switch between "
        "two stages; without that the objective is {:.6g}",
        solved->distance, objective));
    found = std::move(next);
  }
  for (const auto& warning : found->warnings) observers.on_warning(warning);
  auto& result = found->result;
  result.statistics.wall_seconds = result.optimization->statistics.wall_seconds = whole.seconds();
  return std::move(result);
}

}  // namespace saltus::pipeline
