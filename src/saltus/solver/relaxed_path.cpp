#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/solver/relaxed_path_internal.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

constexpr int failures_that_end = 3;
/// Relaxed problems are solved to 1e-4 sigma: from here on to the last digit.
constexpr double sharp_sigma = 1e-6;
constexpr double nearly_feasible = 1e-6;
/// Relaxed problems in a row that lead to a branch which was refused, until the next ones will, too.
constexpr int settled_problems = 2;
/// A point that has gone so many times farther than its start, and is no solution, may be on its way to infinity.
constexpr double astray = 1e6;
/// Iterations of one barrier problem of the loop after which another way is better.
constexpr int longest_barrier = 100;

}  // namespace

RelaxedPath::RelaxedPath(Run& run, Attempt attempt) : RelaxedPath(run, std::move(attempt), PathProgress{}) {
  at_.w = at_.point.w = attempt_.w;
  at_.infeasibility = infeasibility_of(at_.w);
}

RelaxedPath::RelaxedPath(Run& run, Attempt attempt, PathProgress progress)
    : run_(run),
      attempt_(std::move(attempt)),
      crossing_(run),
      relaxed_(std::make_unique<homotopy::RelaxedProblem>(run.problem, run.options.relaxation, attempt_.steering)),
      schedule_(run.schedule),
      at_(std::move(progress)) {
  if (at_.sigma == 0.0) return;
  relaxed_->set_sigma(at_.sigma);
  attempt_.name.clear();  // it is in the record
}

PathEnd RelaxedPath::follow(double until) {
  return follow_from(at_.level ? run_.schedule.next(at_.level->sigma) : attempt_.sigma_initial, until);
}

PathEnd RelaxedPath::follow_from(double sigma, double until) {
  const auto& schedule = run_.schedule;
  int failures = 0;
  // Behind the last one, too, where only digits are missing.
  const auto next = [&] { return sigma > schedule.sigma_final ? schedule.next(sigma) : schedule.sigma_factor * sigma; };
  for (;; sigma = next()) {
    const bool is_last = sigma <= schedule.sigma_final;
    if (run_.is_over()) return PathEnd::stopped;
    failures = solve(sigma) ? 0 : failures + 1;
    if (run_.is_over()) return PathEnd::stopped;
    if (const auto end = end_at(is_last, failures)) return *end;
    if (failures == 0 && sigma <= until) return PathEnd::paused;
  }
}

PathEnd RelaxedPath::loop(double until) {
  if (!at_.level) {
    const bool is_solved =
        solve(attempt_.sigma_initial, homotopy::first_tolerance(attempt_.sigma_initial), attempt_.iteration_limit);
    if (run_.is_over()) return PathEnd::stopped;
    // The next problems of the loop go on from a feasible point as they would within one problem.
    const bool is_usable = at_.has_point && at_.report.termination == Termination::iteration_limit;
    if (!is_solved && !is_usable) return PathEnd::failed;
    set_level({.sigma = attempt_.sigma_initial, .mu = 0.0});
    if (attempt_.sigma_initial <= until) return PathEnd::paused;
  }
  if (!homotopy::next_level(run_.schedule, *at_.level)) return follow();
  PathProgress solved = at_;
  PathEnd end = run_loop(until, solved);
  const bool has_taken_whole_steps = schedule_.sigma_factor == run_.schedule.sigma_factor;
  // Where a branch is known another path is worth more.
  if (end == PathEnd::failed && !run_.is_over() && has_taken_whole_steps && run_.known.empty() && until == 0.0) {
    // Where sigma has fallen too far at once the solution before is still near one of half the way.
    schedule_.sigma_factor = std::sqrt(schedule_.sigma_factor);
    at_ = solved;
    end = run_loop(until, solved);
  }
  if (end != PathEnd::failed || run_.is_over()) return run_.is_over() ? PathEnd::stopped : end;
  // What is left undecided at the last relaxed problem that was solved may not matter.
  const bool may_cross = run_.options.crossover && until == 0.0;
  if (may_cross && crossing_.cross({at_.w, at_.level->sigma, /*is_of_loop=*/false, /*is_last=*/false})) {
    return PathEnd::crossed_over;
  }
  return until == 0.0 ? follow() : PathEnd::failed;
}

/// Leaves in `solved` the last problem that was solved.
PathEnd RelaxedPath::run_loop(double until, PathProgress& solved) {
  is_in_loop_ = true;
  homotopy::Level level = *homotopy::next_level(schedule_, *at_.level);
  NlpPoint point = at_.point;
  move_to(level.sigma);
  std::optional<PathEnd> end;
  int counted = 0;
  const auto next = [&](const NlpPoint& at, double /*mu*/, int iterations) -> std::optional<NextBarrier> {
    const auto following = homotopy::next_level(schedule_, level);
    const bool is_same = following && following->sigma == level.sigma;
    if (is_same) {
      level = *following;
      return NextBarrier{.mu = level.mu, .is_changed = false};
    }
    move_back();
    NlpReport report;
    report.termination = Termination::completed;
    report.iterations = iterations - std::exchange(counted, iterations);
    take(at, report);
    set_level(level);
    solved = at_;
    end = run_.is_over() ? PathEnd::stopped : end_at(/*is_last=*/false, 0);
    if (!end && level.sigma <= until) end = PathEnd::paused;
    if (end || !following) return std::nullopt;
    level = *following;
    move_to(level.sigma);
    return NextBarrier{.mu = level.mu, .is_changed = true};
  };
  const NlpOptions options = run_.nlp_options(run_.iteration_limit);
  NlpReport report = run_.nlp.follow(*relaxed_, point, options, level.mu, longest_barrier, next);
  run_.count_evaluation(std::exchange(report.evaluation_seconds, 0.0));
  is_in_loop_ = false;
  if (end) return *end;
  // The loop's last problem is solved to its barrier only.
  if (report.termination == Termination::completed) return follow_from(level.sigma);
  move_back();
  report.iterations -= counted;
  take(point, report);
  return PathEnd::failed;
}

/// Whether the path ends with the problem that was solved last; that many have failed in a row, 0: it was solved.
std::optional<PathEnd> RelaxedPath::end_at(bool is_last, int failures) {
  const bool is_solved = failures == 0;
  const double sigma = at_.sigma;
  // A solver that fails near a solution fails for its last digits only.
  const bool is_usable = is_solved || at_.has_point;
  if (is_usable && run_.options.crossover && crossing_.cross({at_.w, sigma, is_in_loop_, is_last})) {
    return PathEnd::crossed_over;
  }
  if (crossing_.leads_to_found() || (is_solved && has_settled())) return PathEnd::finished;
  // Problems of larger sigma, and those of the loop, are not solved as sharply.
  const bool is_sharp =
      is_solved && !is_in_loop_ && sigma <= sharp_sigma && at_.infeasibility <= 0.1 * run_.options.tolerance;
  if (is_sharp && !run_.options.crossover) return PathEnd::finished;
  if (failures >= failures_that_end) return PathEnd::failed;
  if (is_last && !(is_solved && is_nearly_done())) return is_solved ? PathEnd::finished : PathEnd::failed;
  return std::nullopt;
}

double RelaxedPath::infeasibility_of(const linalg::Vector& w) {
  return std::max(certificate::scaled_infeasibility(run_.problem, w), certificate::complementarity(run_.problem, w));
}

/// The sides stay those of a branch that was refused, and what is left of the path cannot lift the relaxed objective
/// to it: its own elements have lengths that no branch has.
bool RelaxedPath::has_settled() const {
  if (crossing_.same_refused() < settled_problems) return false;
  const double rise = std::abs(at_.objective - at_.last_objective);
  return at_.objective + 2.0 * rise + Crossing::slack(at_.objective) < crossing_.refused_objective();
}

/// Where no branch was accepted, and the relaxed point itself is a solution but for a digit or two.
bool RelaxedPath::is_nearly_done() const {
  const double tolerance = run_.options.tolerance;
  return run_.options.crossover && at_.infeasibility > tolerance && at_.infeasibility <= 100.0 * tolerance &&
         at_.sigma > 1e-3 * run_.schedule.sigma_final;
}

/// With the multipliers of the problem before, where they are wanted and there.
NlpPoint RelaxedPath::start(NlpOptions& options) {
  auto& relaxed = *relaxed_;
  NlpPoint point{.w = relaxed.with_elastic_variables(at_.w), .y = {}, .z_lower = {}, .z_upper = {}};
  if (run_.options.warm_start != homotopy::WarmStart::primal_dual) return point;
  if (at_.has_multipliers) {
    point.y = at_.point.y;
    point.z_lower = at_.point.z_lower;
    point.z_upper = at_.point.z_upper;
  } else if (attempt_.multipliers.rows.size() == run_.problem.constraints() &&
             attempt_.multipliers.lower.size() == at_.w.size() && attempt_.multipliers.upper.size() == at_.w.size()) {
    point.y = linalg::Vector::zero(relaxed.constraints());
    point.y.head(run_.problem.constraints()) = attempt_.multipliers.rows;
    point.z_lower = point.z_upper = linalg::Vector::ones(relaxed.variables());
    point.z_lower.head(at_.w.size()) = attempt_.multipliers.lower;
    point.z_upper.head(at_.w.size()) = attempt_.multipliers.upper;
  } else {
    return point;
  }
  // Products of pairs are of the order of sigma, and so are those of bounds and their multipliers.
  options.first_barrier_mu = std::clamp(std::pow(at_.sigma, 1.2), 1e-9, 0.1);
  options.warm_push = std::clamp(*options.first_barrier_mu, 1e-9, 1e-5);
  return point;
}

void RelaxedPath::set_level(const homotopy::Level& level) {
  at_.level = level;
  at_.solved = {.w = at_.w, .sigma = level.sigma};
}

/// Makes the functions those of the relaxed problem of this sigma, with the method's terms for a start at w.
void RelaxedPath::move_to(double sigma) {
  at_.sigma = run_.relaxed.sigma = sigma;
  started_ = run_.seconds();
  run_.problem.relaxed_by(std::min(1.0, sigma / run_.schedule.sigma_initial));
  relaxed_->set_sigma(sigma);
  run_.problem.with_method_terms(at_.w);
}

/// Makes them those of the problem itself.
void RelaxedPath::move_back() {
  run_.problem.without_method_terms();
  run_.problem.relaxed_by(0.0);
  relaxed_->set_sigma(at_.sigma);
}

/// Solves the problem of one sigma, to 1e-4 sigma if nothing else is wanted; false if it failed.
bool RelaxedPath::solve(double sigma, std::optional<double> tolerance, int iteration_limit) {
  move_to(sigma);
  NlpOptions options = run_.nlp_options(iteration_limit);
  options.tolerance = std::max(tolerance.value_or(std::min(1e-4 * sigma, 1e-6)), options.tolerance);
  NlpPoint point = start(options);
  const NlpReport report = run_.nlp.solve(*relaxed_, point, options);
  move_back();
  const bool is_solved = take(point, report);
  if (is_solved) set_level({.sigma = sigma, .mu = 0.0});
  return is_solved;
}

/// Keeps the point of a relaxed problem if it is no worse than the one before; false if it is none.
bool RelaxedPath::take(const NlpPoint& point, const NlpReport& report) {
  const linalg::Vector w = point.w.head(at_.w.size());
  const double violation = certificate::scaled_infeasibility(run_.problem, w);
  const double complementarity = certificate::complementarity(run_.problem, w);
  const double infeasibility = point.w.all_finite() && !report.diverging ? std::max(violation, complementarity) : NAN;
  const bool stands_still =
      report.termination == Termination::step_size_too_small && violation <= run_.options.tolerance;
  const bool is_solved = report.termination == Termination::completed || stands_still;
  at_.has_point = false;
  if (is_solved || infeasibility <= at_.infeasibility) {
    at_.has_point = violation <= nearly_feasible;
    at_.w = w;
    at_.infeasibility = infeasibility;
    at_.has_multipliers = is_solved;
    at_.point = point;
    at_.report = report;
  }
  at_.last_objective = at_.objective;
  at_.objective = run_.problem.objective(at_.w);
  const bool is_far = w.all_finite() && w.max_abs() > astray * std::max(1.0, attempt_.w.max_abs());
  const bool falls = !is_solved && is_far && falls_without_end(run_, w);
  run_.is_diverging = report.diverging || falls;
  if (falls) run_.stopped = Termination::not_converged;  // no other sigma changes that
  run_.is_infeasible = run_.is_infeasible || report.termination == Termination::infeasible;
  run_.failure = is_solved ? "" : report.message;
  result::HomotopyStep step;
  step.sigma = at_.sigma;
  step.objective = run_.problem.objective(w);
  step.primal_infeasibility = violation;
  step.complementarity_residual = complementarity;
  step.message = std::exchange(attempt_.name, {});
  if (!step.message.empty() && !report.message.empty()) step.message += ": " + report.message;
  run_.record(step, &report, started_);
  return is_solved;
}

}  // namespace saltus::solver
