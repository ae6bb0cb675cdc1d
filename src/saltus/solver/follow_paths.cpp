#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/solver/exploration_internal.hpp"

namespace saltus::solver {
namespace {

using homotopy::Steering;

/// Iterations of the first problem of a path that is compared with one to come: a hard one is not worth more.
constexpr int compared_iterations = 250;
/// Relaxed objectives are compared where the paths begin, and those of many at the first sigma that is not above this.
constexpr double second_sigma = 1e-2;
/// Relative difference of points of the same relaxed solution.
constexpr double same_point = 1e-2;
/// Relative difference of relaxed objectives of paths to the same branch.
constexpr double equal_objectives = 1e-4;
/// Relative difference of starts that were computed in two ways.
constexpr double same_start = 1e-6;

/// Whether only values of functions depend on sigma: bounds stay while a loop runs. That of an elastic problem is a
/// price.
bool has_loop(const Run& run) {
  const auto relaxation = run.options.relaxation;
  return run.options.strategy == Strategy::structured && run.problem.pairs() > 0 &&
         run.options.steering == Steering::direct &&
         homotopy::lower_bound(relaxation, 1.0) == homotopy::lower_bound(relaxation, 2.0);
}

/// Where a feasible branch is known, half of all iterations belong to what is better beside it.
bool is_enough(const Run& run) { return run.refused && run.solution.iterations > run.iteration_limit / 2; }

bool is_near(const linalg::Vector& a, const linalg::Vector& b, double tolerance) {
  return (a - b).max_abs() <= tolerance * std::max(1.0, b.max_abs());
}

bool has_ended(PathEnd end) { return end != PathEnd::paused && end != PathEnd::failed; }

/// Paths from several starts and first sigmas, the most promising first.
///
/// Relaxed objectives rise while sigma falls: a path whose objective is above that of a branch leads to no better one.
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
    const double cost = run_.problem.objective(first.w);
    std::vector<double> excess;
    for (const auto& other : others) {
      excess.push_back(is_defined(other.w) ? run_.problem.objective(other.w) - cost : HUGE_VAL);
    }
    const auto is_no_dearer = [](double more) { return more <= 0.0; };
    if (std::any_of(excess.begin(), excess.end(), is_no_dearer)) compared_ = std::min(compared_, small());
    best_start_ = first.w;
    std::vector<Attempt> starts, rest;
    add_start(first, sigmas_, starts);
    const int random_starts = run_.options.compared_starts.value_or(0);
    // Many starts are worth more than a second sigma. What costs the same, as the same states with other selections do,
    // leads elsewhere from the large one, if at all.
    const std::vector<double> large{sigmas_.front()}, last{sigmas_.back()};
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (is_near(others[i].w, first.w, same_start)) continue;
      const bool is_compared = random_starts > 0 || is_no_dearer(excess[i]);
      const auto& sigmas = random_starts > 0 ? last : excess[i] == 0.0 ? large : sigmas_;
      add_start(beside(first, others[i].w, others[i].name), sigmas, is_compared ? starts : rest);
    }
    for (int seed = 1; seed <= random_starts; ++seed) {
      const linalg::Vector w = start_of_seed(run_.problem, first.w, seed);
      add_start(beside(first, w, fmt::format("the random start of seed {}", seed)), last, starts);
    }
    if (const PathEnd end = compare(starts); has_ended(end)) return end;
    if (candidates_.empty() && !rest.empty()) {
      if (const PathEnd end = compare(rest); has_ended(end)) return end;
    }
    return follow_best();
  }

  [[nodiscard]] const linalg::Vector& best_start() const { return best_start_; }
  [[nodiscard]] const std::optional<SolvedPoint>& last_solved() const { return last_solved_; }

 private:
  struct Candidate {
    std::unique_ptr<RelaxedPath> path;
    double objective = 0.0;
    linalg::Vector start;
    double compared = objective;  ///< objective where paths were compared
  };

  [[nodiscard]] double small() const { return run_.schedule.next(run_.schedule.sigma_initial); }
  [[nodiscard]] bool is_defined(const linalg::Vector& w) const {
    linalg::Vector c(run_.problem.rows());
    run_.problem.functions(w, c);
    return c.all_finite() && std::isfinite(run_.problem.objective(w));
  }
  static Attempt beside(const Attempt& first, const linalg::Vector& w, const std::string& name) {
    Attempt attempt = first;
    attempt.w = w;
    attempt.name = "begins at " + name;
    attempt.iteration_limit = compared_iterations;
    return attempt;
  }

  /// From one start with each of these sigmas, if functions are finite there.
  void add_start(Attempt attempt, const std::vector<double>& sigmas, std::vector<Attempt>& starts) const {
    if (!is_defined(attempt.w)) return;
    const int last_limit = attempt.iteration_limit;
    for (const double sigma : sigmas) {
      attempt.sigma_initial = sigma;
      attempt.iteration_limit = sigma == sigmas.back() ? last_limit : compared_iterations;
      starts.push_back(attempt);
    }
  }

  /// Paths down to the sigma where they are compared. It has ended where no time is left and none has come so far: then
  /// the first one is shown.
  PathEnd compare(const std::vector<Attempt>& starts) {
    auto explored = explore(run_, starts, compared_);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      auto& [end, progress] = explored[i];
      if (end != PathEnd::paused && end != PathEnd::finished) continue;
      const double objective = progress.objective;
      auto path = std::make_unique<RelaxedPath>(run_, starts[i], std::move(progress));
      candidates_.push_back({std::move(path), objective, starts[i].w});
    }
    if (!candidates_.empty() || !run_.is_over()) return PathEnd::paused;
    RelaxedPath(run_, starts.front(), std::move(explored.front().progress)).show();
    return PathEnd::stopped;
  }

  /// Always the path of the lowest objective, until none can lead to a better branch than the best one.
  PathEnd follow_best() {
    drop_twins();
    if (!candidates_.empty()) best_start_ = candidates_[most_promising()].start;
    const int most = run_.solution.iterations + (run_.iteration_limit - run_.solution.iterations) / 3;
    PathEnd end = PathEnd::failed;
    while (!candidates_.empty() && !is_enough(run_) && !(best_ && run_.solution.iterations > most)) {
      const auto next = candidates_.begin() + static_cast<std::ptrdiff_t>(most_promising());
      if (const double lowest = lowest_branch(); next->objective >= lowest - Crossing::slack(lowest)) break;
      const PathEnd of_path = advance(*next);
      if (of_path == PathEnd::paused) {
        next->objective = next->path->objective();
        continue;
      }
      if (of_path == PathEnd::failed) {
        leave_motion(*next);
      } else if (!best_) {
        next->path->show();
        end = of_path;
      }
      keep_branch();
      if (of_path == PathEnd::stopped) break;
      const double compared = next->compared;
      candidates_.erase(next);
      if (lowest_branch() < HUGE_VAL) drop_equals(compared);
    }
    if (!best_) return end;
    // One that was refused, since its own relaxed objective is lower still, may be better than all that were accepted.
    const bool is_refused_better = run_.refused && run_.refused->objective < best_->objective;
    run_.branch = std::move(is_refused_better ? run_.refused : best_);
    return PathEnd::crossed_over;
  }

  /// The first of those whose objectives are the lowest: the given start comes before random ones.
  [[nodiscard]] std::size_t most_promising() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& candidate : candidates_) lowest = std::min(lowest, candidate.objective);
    std::size_t k = 0;
    while (!(candidates_[k].objective <= lowest + Crossing::slack(lowest)) && k + 1 < candidates_.size()) ++k;
    return k;
  }

  /// One of those that have come to the same solution is enough.
  void drop_twins() {
    const auto are_twins = [](const Candidate& a, const Candidate& b) {
      if (std::abs(a.objective - b.objective) > Crossing::slack(a.objective)) return false;
      const auto &of_a = a.path->last_solved()->w, &of_b = b.path->last_solved()->w;
      return is_near(of_b, of_a, same_point);
    };
    std::vector<Candidate> kept;
    for (auto& candidate : candidates_) {
      const auto is_known = [&](const Candidate& other) { return are_twins(other, candidate); };
      if (std::none_of(kept.begin(), kept.end(), is_known)) kept.push_back(std::move(candidate));
    }
    candidates_ = std::move(kept);
  }

  /// Of feasible ones: that of a refused one is as good a bound.
  [[nodiscard]] double lowest_branch() const {
    double lowest = HUGE_VAL;
    if (best_) lowest = best_->objective;
    return run_.refused ? std::min(lowest, run_.refused->objective) : lowest;
  }

  /// Paths that cost the same where they were compared differ by lengths of elements without a switch: one that leads
  /// to a branch is enough.
  void drop_equals(double objective) {
    const double most = equal_objectives * std::max(1.0, std::abs(objective));
    std::erase_if(candidates_, [&](const Candidate& other) { return std::abs(other.compared - objective) <= most; });
  }

  /// To the next sigma at which paths are compared, else to its end.
  PathEnd advance(Candidate& candidate) {
    auto& path = *candidate.path;
    const bool has_many = run_.options.compared_starts.value_or(0) > 0;
    const bool is_compared = has_many && candidates_.size() > 1 && path.last_solved()->sigma > second_sigma;
    const double until = is_compared ? second_sigma : 0.0;
    const PathEnd end = path.loop(until);
    return end == PathEnd::failed && is_compared ? path.follow(until) : end;
  }

  /// What a failed path has come to may be that of a motion.
  void leave_motion(const Candidate& candidate) {
    const auto& solved = candidate.path->last_solved();
    if (!last_solved_) last_solved_ = solved;
    if (run_.options.crossover && solved) static_cast<void>(Crossing(run_).try_motion(solved->w, &solved->w));
  }

  void keep_branch() {
    if (run_.branch && !(best_ && best_->objective <= run_.branch->objective)) best_ = std::move(run_.branch);
    run_.branch.reset();
    if (best_) run_.best_before = best_->objective;
  }

  Run& run_;
  std::vector<double> sigmas_;  ///< first ones
  double compared_ = 0.0;       ///< where objectives are compared
  std::vector<Candidate> candidates_;
  linalg::Vector best_start_;
  std::optional<crossover::Branch> best_;
  std::optional<SolvedPoint> last_solved_;  ///< of the first path that failed
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
