#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "saltus/solver/relaxed_path_internal.hpp"

namespace saltus::solver {
namespace {

using homotopy::Steering;

/// Iterations of the first problem of a path that is compared with one to come: a hard one is not worth more.
constexpr int compared_iterations = 250;

/// Whether only values of functions depend on sigma: bounds stay while a loop runs. That of an elastic problem is a
/// price.
bool has_loop(const Run& run) {
  const auto relaxation = run.options.relaxation;
  return run.options.strategy == Strategy::structured && run.problem.pairs() > 0 &&
         run.options.steering == Steering::direct &&
         homotopy::lower_bound(relaxation, 1.0) == homotopy::lower_bound(relaxation, 2.0);
}

PathEnd shown(RelaxedPath& path, PathEnd end) {
  path.show();
  return end;
}

/// Where a feasible branch is known, half of all iterations belong to what is better beside it.
bool is_enough(const Run& run) { return run.refused && run.solution.iterations > run.options.iteration_limit / 2; }

bool has_ended(PathEnd end) { return end != PathEnd::paused && end != PathEnd::failed; }

/// The loops that can be compared at one sigma.
class ComparedLoops {
 public:
  explicit ComparedLoops(Run& run) : run_(run) {
    const double factor = run.schedule.sigma_factor;
    // So large that pairs hardly matter, and so small that they matter at once.
    sigmas_ = {run.schedule.sigma_initial / (factor * factor), small()};
    if (run.options.sigma_initial) sigmas_ = {*run.options.sigma_initial};
    compared_ = sigmas_.back();
  }

  /// Where it ended; where it failed, best_start() and last_solved() say where to begin another path.
  [[nodiscard]] PathEnd follow(const Attempt& first, const std::vector<mpcc::NamedStart>& others) {
    const auto cheaper = [&](const mpcc::NamedStart& other) { return has_lower_cost(other.w, first.w); };
    if (std::any_of(others.begin(), others.end(), cheaper)) compared_ = std::min(compared_, small());
    best_start_ = first.w;
    if (const PathEnd end = add(first); has_ended(end)) return end;
    for (const auto& other : others) {
      if (!cheaper(other) && !(candidates_.empty() && is_defined(other.w))) continue;
      Attempt attempt = first;
      attempt.w = other.w;
      attempt.name = "begins at " + other.name;
      attempt.iteration_limit = compared_iterations;
      if (const PathEnd end = add(attempt); has_ended(end)) return end;
    }
    return follow_best();
  }

  [[nodiscard]] const linalg::Vector& best_start() const { return best_start_; }
  [[nodiscard]] std::optional<SolvedPoint> last_solved() const {
    if (candidates_.empty()) return std::nullopt;
    return candidates_.front().path->last_solved();
  }

 private:
  struct Candidate {
    std::unique_ptr<RelaxedPath> path;
    double objective = 0.0;
    linalg::Vector start;
  };

  [[nodiscard]] double small() const { return run_.schedule.next(run_.schedule.sigma_initial); }
  [[nodiscard]] bool is_defined(const linalg::Vector& w) const {
    linalg::Vector c(run_.problem.rows());
    run_.problem.functions(w, c);
    return c.all_finite() && std::isfinite(run_.problem.objective(w));
  }
  [[nodiscard]] bool has_lower_cost(const linalg::Vector& a, const linalg::Vector& b) const {
    return is_defined(a) && run_.problem.objective(a) < run_.problem.objective(b);
  }

  /// Both first sigmas from one start.
  PathEnd add(Attempt attempt) {
    const std::string name = attempt.name;
    const int last_limit = attempt.iteration_limit;
    for (const double sigma : sigmas_) {
      attempt.sigma_initial = sigma;
      attempt.name = name;
      attempt.iteration_limit = sigma == sigmas_.back() ? last_limit : compared_iterations;
      auto path = std::make_unique<RelaxedPath>(run_, attempt);
      const PathEnd end = path->loop(compared_);
      if (has_ended(end)) return shown(*path, end);
      const double objective = path->objective();
      if (end == PathEnd::paused) candidates_.push_back({std::move(path), objective, attempt.w});
    }
    return PathEnd::failed;
  }

  PathEnd follow_best() {
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const auto& a, const auto& b) { return a.objective < b.objective; });
    if (!candidates_.empty()) best_start_ = candidates_.front().start;
    for (auto& candidate : candidates_) {
      const PathEnd end = candidate.path->loop();
      if (end != PathEnd::failed) return shown(*candidate.path, end);
      const auto solved = candidate.path->last_solved();
      if (run_.options.crossover && solved && Crossing(run_).try_motion(solved->w, &solved->w)) {
        return PathEnd::crossed_over;
      }
      if (is_enough(run_)) break;
    }
    return PathEnd::failed;
  }

  Run& run_;
  std::vector<double> sigmas_;  ///< first ones
  double compared_ = 0.0;       ///< where objectives are compared
  std::vector<Candidate> candidates_;
  linalg::Vector best_start_;
};

}  // namespace

PathEnd follow_paths(Run& run, const Start& start, const std::vector<mpcc::NamedStart>& others) {
  Attempt attempt{.w = start.w,
                  .multipliers = start.multipliers,
                  .steering = run.options.steering,
                  .sigma_initial = run.schedule.sigma_initial};
  PathEnd end = PathEnd::failed;
  const auto follow = [&] {
    RelaxedPath path(run, attempt);
    end = path.follow();
    path.show();
    return end != PathEnd::failed;
  };
  std::optional<SolvedPoint> solved;
  if (has_loop(run)) {
    ComparedLoops loops(run);
    end = loops.follow(attempt, others);
    if (end != PathEnd::failed) return end;
    attempt.w = loops.best_start();
    solved = loops.last_solved();
    const bool may_cross = run.options.crossover;
    if (may_cross && Crossing(run).try_motion(start.w, solved ? &solved->w : nullptr)) return PathEnd::crossed_over;
  }
  if (is_enough(run) || follow() || is_enough(run)) return end;
  attempt.sigma_initial = run.schedule.next(run.schedule.sigma_initial);
  if (follow() || is_enough(run) || run.options.steering == Steering::l1) return end;
  attempt.sigma_initial = solved ? solved->sigma : run.schedule.sigma_initial;
  if (solved) attempt.w = std::move(solved->w);
  attempt.steering = Steering::l1;
  follow();
  return end;
}

}  // namespace saltus::solver
