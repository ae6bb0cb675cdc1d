#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

/// Crossing over earlier costs more than the next relaxed problem (mpcc.md's C.1: right from here on the easy ones).
constexpr double crossover_sigma = 1e-3;
constexpr int failures_that_end = 3;
/// Relaxed problems are solved to 1e-4 sigma: from here on to the last digit.
constexpr double sharp_sigma = 1e-6;
/// A branch that is feasible only far from where the path has led to is a solution at infinity.
constexpr double far_away = 1e5;
constexpr double nearly_feasible = 1e-6;
/// Optimality error of a branch problem that counts as solved; the certificate has the last word.
constexpr double stationary = 1e-5;
/// A branch problem that was infeasible is tried again from a point that is nearer by this.
constexpr double retry_factor = 0.011;
/// Iterations of a branch problem that the next sigma may make easier, and of one that it may not.
constexpr int trial_limit = 60;
constexpr int whole_limit = 500;
/// How much worse than the relaxed point a branch may be: relaxed points are better than any feasible one.
constexpr double objective_slack = 1e-3;
/// Relaxed problems in a row that lead to a branch which was refused, until the next ones will, too.
constexpr int settled_problems = 2;

/// Follows one schedule.
class Path {
 public:
  Path(Run& run, const Attempt& attempt) : run_(run), attempt_(attempt) {
    run_.relaxed.problem =
        std::make_unique<homotopy::RelaxedProblem>(run.problem, run.options.relaxation, attempt.steering);
    w_ = attempt.w;
    infeasibility_ = infeasibility_of(w_);
  }

  PathEnd follow() {
    const auto& schedule = run_.options.schedule;
    int failures = 0;
    bool is_behind_last = false;
    for (double sigma = attempt_.sigma_initial;; sigma *= schedule.sigma_factor) {
      // The last factor is cut short; 1.0001 keeps rounding from adding one more problem at nearly the same sigma.
      const bool is_last = sigma <= 1.0001 * schedule.sigma_final;
      if (is_last && !is_behind_last) sigma = schedule.sigma_final;
      is_behind_last = is_last;
      if (run_.is_over()) return PathEnd::stopped;
      failures = solve(sigma) ? 0 : failures + 1;
      if (run_.is_over()) return PathEnd::stopped;
      if (const auto end = end_at(sigma, is_last, failures)) return *end;
    }
  }

 private:
  /// Whether the path ends with the problem of this sigma; that many have failed in a row, 0: it was solved.
  [[nodiscard]] std::optional<PathEnd> end_at(double sigma, bool is_last, int failures) {
    const bool is_solved = failures == 0;
    // A solver that fails near a solution fails for its last digits only.
    const bool is_usable = is_solved || has_point_;
    if (is_usable && run_.options.crossover && cross_over(sigma, is_last)) return PathEnd::crossed_over;
    if (is_solved && has_settled()) return PathEnd::finished;
    // Problems of larger sigma are not solved as sharply.
    const bool is_sharp = is_solved && sigma <= sharp_sigma && infeasibility_ <= 0.1 * run_.options.tolerance;
    if (is_sharp && !run_.options.crossover) return PathEnd::finished;
    if (failures >= failures_that_end) return PathEnd::failed;
    if (is_last && !(is_solved && is_nearly_done(sigma))) return is_solved ? PathEnd::finished : PathEnd::failed;
    return std::nullopt;
  }

  [[nodiscard]] double infeasibility_of(const linalg::Vector& w) {
    return std::max(certificate::scaled_infeasibility(run_.problem, w), certificate::complementarity(run_.problem, w));
  }

  /// The sides stay those of a branch that was refused, and what is left of the path cannot lift the relaxed objective
  /// to it: its own elements have lengths that no branch has.
  [[nodiscard]] bool has_settled() const {
    if (same_refused_ < settled_problems) return false;
    const double rise = std::abs(objective_ - last_objective_);
    return objective_ + 2.0 * rise + objective_slack * std::max(1.0, std::abs(objective_)) < run_.refused->objective;
  }

  /// Where no branch was accepted, and the relaxed point itself is a solution but for a digit or two.
  [[nodiscard]] bool is_nearly_done(double sigma) const {
    const double tolerance = run_.options.tolerance;
    return run_.options.crossover && infeasibility_ > tolerance && infeasibility_ <= 100.0 * tolerance &&
           sigma > 1e-3 * run_.options.schedule.sigma_final;
  }

  /// With the multipliers of the problem before, where they are wanted and there.
  [[nodiscard]] NlpPoint start(double sigma, NlpOptions& options) {
    auto& relaxed = *run_.relaxed.problem;
    NlpPoint point{.w = relaxed.with_elastic_variables(w_), .y = {}, .z_lower = {}, .z_upper = {}};
    if (run_.options.warm_start != homotopy::WarmStart::primal_dual) return point;
    const auto& last = run_.relaxed.point;
    if (has_multipliers_) {
      point.y = last.y;
      point.z_lower = last.z_lower;
      point.z_upper = last.z_upper;
    } else if (attempt_.multipliers.rows.size() == run_.problem.constraints() &&
               attempt_.multipliers.lower.size() == w_.size() && attempt_.multipliers.upper.size() == w_.size()) {
      point.y = linalg::Vector::zero(relaxed.constraints());
      point.y.head(run_.problem.constraints()) = attempt_.multipliers.rows;
      point.z_lower = point.z_upper = linalg::Vector::ones(relaxed.variables());
      point.z_lower.head(w_.size()) = attempt_.multipliers.lower;
      point.z_upper.head(w_.size()) = attempt_.multipliers.upper;
    } else {
      return point;
    }
    // Products of pairs are of the order of sigma, and so are those of bounds and their multipliers.
    options.warm_barrier_mu = std::clamp(std::pow(sigma, 1.2), 1e-9, 0.1);
    options.warm_push = std::clamp(*options.warm_barrier_mu, 1e-9, 1e-5);
    return point;
  }

  /// Solves the problem of one sigma; false if it failed. Its point is kept if it is no worse than the one before.
  bool solve(double sigma) {
    const double started = run_.seconds();
    auto& relaxed = *run_.relaxed.problem;
    run_.problem.relaxed_by(sigma / run_.options.schedule.sigma_initial);
    relaxed.set_sigma(sigma);
    run_.relaxed.sigma = sigma;
    NlpOptions options = run_.nlp_options();
    options.tolerance = std::clamp(1e-4 * sigma, options.tolerance, 1e-6);
    NlpPoint point = start(sigma, options);
    run_.problem.with_method_terms(w_);
    const NlpReport report = run_.nlp.solve(relaxed, point, options);
    run_.problem.without_method_terms();
    run_.problem.relaxed_by(0.0);
    relaxed.set_sigma(sigma);

    const linalg::Vector w = point.w.head(w_.size());
    const double infeasibility = point.w.all_finite() && !report.diverging ? infeasibility_of(w) : NAN;
    const bool stands_still = report.termination == Termination::step_size_too_small &&
                              certificate::scaled_infeasibility(run_.problem, w) <= run_.options.tolerance;
    const bool is_solved = report.termination == Termination::completed || stands_still;
    has_point_ = false;
    if (is_solved || infeasibility <= infeasibility_) {
      has_point_ = certificate::scaled_infeasibility(run_.problem, w) <= nearly_feasible;
      w_ = w;
      infeasibility_ = infeasibility;
      has_multipliers_ = is_solved;
      run_.relaxed.point = point;
      run_.relaxed.report = report;
    }
    last_objective_ = objective_;
    objective_ = run_.problem.objective(w_);
    note_failure(report, is_solved);
    result::HomotopyStep step;
    step.sigma = sigma;
    step.objective = run_.problem.objective(w);
    step.primal_infeasibility = certificate::scaled_infeasibility(run_.problem, w);
    step.complementarity_residual = certificate::complementarity(run_.problem, w);
    run_.record(step, &report, started);
    return is_solved;
  }

  void note_failure(const NlpReport& report, bool is_solved) {
    run_.is_diverging = report.diverging;
    run_.is_infeasible = run_.is_infeasible || report.termination == Termination::infeasible;
    run_.failure = is_solved ? "" : report.message;
  }

  /// True if the branch of the smaller sides is good enough.
  bool cross_over(double sigma, bool is_last) {
    if (run_.problem.pairs() > 0 && sigma > 1.0001 * crossover_sigma) return false;
    linalg::Vector c(run_.problem.rows());
    run_.problem.functions(w_, c);
    const auto sides = crossover::smaller_sides(run_.problem, run_.groups, c);
    // The same sides have the same solution: what was refused for its objective needs no second solution, what was
    // infeasible deserves one from much nearer only.
    const bool is_refused = run_.refused && run_.refused->sides == sides;
    same_refused_ = is_refused ? same_refused_ + 1 : 0;
    if (is_refused) return accept_refused();
    if (sides == infeasible_sides_ && !is_last && sigma > retry_factor * infeasible_sigma_) return false;
    crossover::Branch branch = run_.solve_branch(sides, w_, is_last ? whole_limit : trial_limit);
    const bool is_near = branch.w.max_abs() <= far_away * std::max(1.0, w_.max_abs());
    const bool is_feasible = branch.is_feasible(run_.options.tolerance) && std::isfinite(branch.objective) && is_near &&
                             branch.optimality_error <= stationary;
    auto& step = run_.solution.homotopy.back();
    if (!is_feasible) {
      infeasible_sides_ = sides;
      infeasible_sigma_ = sigma;
      const std::string rows = certificate::worst_rows(run_.problem, branch.w, run_.options.tolerance);
      step.message = fmt::format("refused: {}", !is_near ? "it lies at infinity" : rows.empty() ? "not solved" : rows);
      return false;
    }
    if (is_good(branch)) {
      run_.branch = std::move(branch);
      return true;
    }
    step.message = fmt::format("refused: the relaxed objective is {:.6g}", run_.problem.objective(w_));
    if (!run_.refused || branch.objective < run_.refused->objective) run_.refused = std::move(branch);
    return false;
  }

  [[nodiscard]] bool is_good(const crossover::Branch& branch) {
    const double relaxed = run_.problem.objective(w_);
    return branch.objective <= relaxed + objective_slack * std::max(1.0, std::abs(relaxed));
  }

  bool accept_refused() {
    if (!is_good(*run_.refused)) return false;
    run_.branch = std::move(run_.refused);
    run_.refused.reset();
    return true;
  }

  Run& run_;
  const Attempt& attempt_;
  linalg::Vector w_;
  double infeasibility_ = 0.0;
  bool has_multipliers_ = false;
  bool has_point_ = false;  ///< of the last relaxed problem, near enough to feasible ones for a branch
  double objective_ = 0.0, last_objective_ = 0.0;  ///< of the last two relaxed points
  int same_refused_ = 0;                           ///< relaxed points in a row with the sides of run_.refused
  std::optional<std::vector<mpcc::ActiveSide>> infeasible_sides_;
  double infeasible_sigma_ = 0.0;
};

}  // namespace

PathEnd follow_relaxed(Run& run, const Attempt& attempt) { return Path(run, attempt).follow(); }

}  // namespace saltus::solver
