#include "saltus/solver/homotopy/follow_path.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/contracts.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/solver/homotopy/relaxed_problem.hpp"

namespace saltus::solver::homotopy {
namespace {

using result::Termination;

Expected<void> check(const PathOptions& options) {
  const auto& [initial, factor, last] = options.schedule;
  const auto refuse = [](std::string message) -> Expected<void> {
    Error error;
    error.code = ErrorCode::invalid_option;
    error.message = std::move(message);
    return tl::unexpected(std::move(error));
  };
  if (!(initial > 0.0 && std::isfinite(initial))) return refuse(fmt::format("sigma_initial = {} is not > 0", initial));
  if (!(factor > 0.0 && factor < 1.0)) return refuse(fmt::format("sigma_factor = {} is not in (0, 1)", factor));
  if (!(last > 0.0 && last <= initial)) {
    return refuse(fmt::format("sigma_final = {} is not in (0, sigma_initial = {}]", last, initial));
  }
  if (!(options.complementarity_tolerance > 0.0 && options.feasibility_tolerance > 0.0)) {
    return refuse("complementarity_tolerance and feasibility_tolerance have to be > 0");
  }
  return {};
}

bool satisfies(const mpcc::Residuals& residuals, const PathOptions& options) {
  return residuals.complementarity_product <= options.complementarity_tolerance &&
         residuals.primal_infeasibility <= options.feasibility_tolerance;
}

bool is_finite(const NlpPoint& point) { return point.w.all_finite(); }

/// What ends the path after this step, if anything does.
void conclude(PathResult& path, const PathOptions& options) {
  const PathStep& last = path.steps.back();
  // Where pairs are biactive a solver cannot always tell optimality from rounding any more; it stands still there.
  const bool stands_still =
      last.nlp.termination == Termination::step_size_too_small && satisfies(path.residuals, options);
  if (last.nlp.termination != Termination::completed && !stands_still) {
    path.termination = last.nlp.termination;
    path.message = fmt::format("the relaxed problem with sigma = {:.3g} ended with: {}", last.sigma, last.nlp.message);
  } else if (satisfies(path.residuals, options)) {
    path.termination = Termination::completed;
    path.message.clear();
  } else {
    path.termination = Termination::verification_failed;
    path.message = fmt::format(
        "the relaxed problem with sigma = {:.3g} is solved, but its solution has max G H = {:.3g} and violates other "
        "constraints by {:.3g}; a smaller sigma_final may help",
        last.sigma, path.residuals.complementarity_product, path.residuals.primal_infeasibility);
  }
}

}  // namespace

Expected<PathResult> follow_path(mpcc::Problem& problem, ConstVectorView start, NlpSolver& solver,
                                 const PathOptions& options, FunctionRef<bool(const PathStep&)> on_step) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  SALTUS_ASSERT(start.size() == problem.variables());
  const Stopwatch stopwatch;
  RelaxedProblem relaxed(problem, options.relaxation);
  PathResult path;
  path.point.w = start;
  for (double sigma = options.schedule.sigma_initial;; sigma = options.schedule.next(sigma)) {
    const bool is_last = sigma <= options.schedule.sigma_final;
    relaxed.set_sigma(sigma);
    NlpOptions nlp = options.nlp;
    if (options.time_limit) {
      const double left = std::max(*options.time_limit - stopwatch.seconds(), 0.0);
      nlp.time_limit = std::min(left, nlp.time_limit.value_or(left));
    }
    if (options.warm_start == WarmStart::primal)
      path.point = {.w = path.point.w, .y = {}, .z_lower = {}, .z_upper = {}};
    const linalg::Vector before = path.point.w;
    const NlpReport report = solver.solve(relaxed, path.point, nlp);
    if (!is_finite(path.point)) path.point = {.w = before, .y = {}, .z_lower = {}, .z_upper = {}};
    path.residuals = mpcc::residuals(problem, path.point.w);
    path.iterations += report.iterations;
    path.steps.push_back({sigma, report, path.residuals});
    conclude(path, options);
    if (!on_step(path.steps.back())) {
      path.termination = Termination::stopped_by_user;
      return path;
    }
    const bool out_of_time = options.time_limit && stopwatch.seconds() >= *options.time_limit;
    if (path.termination == Termination::completed || is_last) return path;
    if (out_of_time || path.termination == Termination::stopped_by_user) {
      if (out_of_time) path.termination = Termination::time_limit;
      return path;
    }
  }
}

}  // namespace saltus::solver::homotopy
