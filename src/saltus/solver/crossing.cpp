#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/solver/crossing_internal.hpp"
#include "saltus/solver/crossover/sides.hpp"

namespace saltus::solver {
namespace {

/// Crossing over earlier costs more than the next relaxed problem. Problems that are solved by themselves are not so
/// near (mpcc.md's C.1: right from here on the easy ones).
constexpr double crossover_sigma = 1e-2;
constexpr double crossover_sigma_of_problems = 1e-3;
/// Where groups are still undecided here, they stay so.
constexpr double undecided_sigma = 1e-5;
/// A branch that is feasible only far from where the path has led to is a solution at infinity.
constexpr double far_away = 1e5;
/// Optimality error of a branch problem that counts as solved; the certificate has the last word.
constexpr double stationary = 1e-5;
/// A branch problem that was infeasible is tried again from a point that is nearer by this.
constexpr double retry_factor = 0.011;
/// Iterations of a branch problem that the next sigma may make easier, and of one that it may not.
constexpr int trial_limit = 60;
constexpr int whole_limit = 500;
/// Of one of a motion: where its modes can serve, that shows soon.
constexpr int motion_limit = 30;
/// Where it has come so near, it goes on.
constexpr double feasible_but_for_digits = 1e-4;
/// Relaxed points are better than any feasible one.
constexpr double objective_slack = 1e-3;
/// Relative difference of objectives of the same point.
constexpr double same_objective = 1e-6;
constexpr double rounding = 1.0001;

}  // namespace

double Crossing::slack(double objective) { return objective_slack * std::max(1.0, std::abs(objective)); }

bool Crossing::is_worth_trying(const RelaxedPoint& point, const linalg::Vector& c) const {
  if (run_.problem.pairs() == 0) return true;
  if (!point.is_of_loop) return point.sigma <= rounding * crossover_sigma_of_problems;
  if (point.sigma > rounding * crossover_sigma) return false;
  return point.sigma <= rounding * undecided_sigma || crossover::undecided_groups(run_.problem, run_.groups, c) == 0;
}

bool Crossing::cross(const RelaxedPoint& point) {
  linalg::Vector c(run_.problem.rows());
  run_.problem.functions(point.w, c);
  if (!is_worth_trying(point, c)) return point.sigma <= rounding * crossover_sigma && try_motion(point.w, &point.w);
  const auto sides = crossover::smaller_sides(run_.problem, run_.groups, c);
  // The same sides have the same solution, whichever path leads to them: what was feasible needs no second one, what
  // was infeasible deserves one from much nearer only.
  const auto known = run_.known.find(sides);
  same_refused_ = known != run_.known.end() ? same_refused_ + 1 : 0;
  if (known != run_.known.end()) return accept_known(sides, known->second, point.w);
  if (sides == infeasible_sides_ && !point.is_last && point.sigma > retry_factor * infeasible_sigma_) return false;
  return solve(point, sides);
}

bool Crossing::is_solved(const crossover::Branch& branch, const linalg::Vector& w) const {
  const bool is_near = branch.w.max_abs() <= far_away * std::max(1.0, w.max_abs());
  return branch.is_feasible(run_.options.tolerance) && std::isfinite(branch.objective) && is_near &&
         branch.optimality_error <= stationary;
}

bool Crossing::solve(const RelaxedPoint& point, const std::vector<mpcc::ActiveSide>& sides) {
  crossover::Branch branch = run_.solve_branch(sides, point.w, point.is_last ? whole_limit : trial_limit);
  if (is_solved(branch, point.w)) return take(std::move(branch), &point.w);
  infeasible_sides_ = sides;
  infeasible_sigma_ = point.sigma;
  const std::string rows = certificate::worst_rows(run_.problem, branch.w, run_.options.tolerance);
  run_.solution.homotopy.back().message = fmt::format("refused: {}", rows.empty() ? "not solved" : rows);
  // Smaller sides may be those of no motion.
  return try_motion(point.w, &point.w);
}

bool Crossing::try_motion(mpcc::ConstVectorView controls, const linalg::Vector* relaxed) {
  const auto motion = run_.problem.motion(controls, [this] { return run_.is_over(); });
  if (!motion || run_.is_over()) return false;
  auto branch = run_.solve_branch(motion->sides, motion->w, motion_limit, "the motion of these controls");
  const bool is_unfinished = branch.report.termination == result::Termination::iteration_limit;
  if (is_unfinished && branch.primal_infeasibility <= feasible_but_for_digits) {
    branch = run_.solve_branch(motion->sides, branch.w, trial_limit, "the motion of these controls");
  }
  if (!branch.is_feasible(run_.options.tolerance) || !std::isfinite(branch.objective)) return false;
  const bool is_comparable = relaxed != nullptr && is_solved(branch, *relaxed);
  return take(std::move(branch), is_comparable ? relaxed : nullptr);
}

bool Crossing::take(crossover::Branch branch, const linalg::Vector* relaxed) {
  run_.known[branch.sides] = branch.objective;
  if (relaxed != nullptr && is_good(branch.objective, *relaxed)) {
    run_.branch = std::move(branch);
    return true;
  }
  const auto& found = run_.best_before;
  if (found && std::abs(branch.objective - *found) <= same_objective * std::max(1.0, std::abs(*found))) {
    leads_to_found_ = true;
  }
  run_.solution.homotopy.back().message =
      relaxed != nullptr ? fmt::format("refused: the relaxed objective is {:.6g}", run_.problem.objective(*relaxed))
                         : "kept for the case that nothing else is found";
  if (!run_.refused || branch.objective < run_.refused->objective) run_.refused = std::move(branch);
  return false;
}

bool Crossing::is_good(double objective, const linalg::Vector& w) const {
  const double relaxed = run_.problem.objective(w);
  return objective <= relaxed + slack(relaxed);
}

bool Crossing::accept_known(const std::vector<mpcc::ActiveSide>& sides, double objective, const linalg::Vector& w) {
  refused_objective_ = objective;
  if (!is_good(objective, w)) return false;
  if (!run_.refused || run_.refused->sides != sides) return true;
  run_.branch = std::move(run_.refused);
  run_.refused.reset();
  return true;
}

}  // namespace saltus::solver
