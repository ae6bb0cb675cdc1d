// One path of relaxed problems.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/solver/crossing_internal.hpp"
#include "saltus/solver/homotopy/lead.hpp"

namespace saltus::solver {

/// Makes one attempt at the path: its start, its first sigma, its steering.
struct Attempt {
  linalg::Vector w;
  MpccMultipliers multipliers;  ///< may be empty
  homotopy::Steering steering = homotopy::Steering::direct;
  double sigma_initial = 1.0;
  int iteration_limit = 500;  ///< of its first problem
  std::string name{};         ///< of its start, where there are several
};

enum class PathEnd {
  crossed_over,  ///< run.branch is accepted
  finished,      ///< the last relaxed problem is solved
  failed,        ///< relaxed problems could not be solved
  stopped,       ///< run.stopped
  paused,        ///< at the sigma that was asked for
};

/// Holds the solution of a relaxed problem.
struct SolvedPoint {
  linalg::Vector w;
  double sigma = 1.0;
};

/// Says how far a path has come. Another path goes on from it, on another copy of the problem, too.
struct PathProgress {
  NlpPoint point{};  ///< of the last relaxed problem, in its variables
  NlpReport report{};
  double sigma = 0.0;  ///< of that problem
  linalg::Vector w;
  double infeasibility = 0.0;
  bool has_multipliers = false;
  bool has_point = false;  ///< of the last relaxed problem, near enough to feasible ones for a branch
  double objective = 0.0, last_objective = 0.0;  ///< of the last two relaxed points
  std::optional<SolvedPoint> solved{};           ///< of the level
  std::optional<homotopy::Level> level{};        ///< solved last
};

/// Follows the relaxed problems for falling sigma, and tries to cross over behind each. What it comes to is
/// run.relaxed only where it is shown.
class RelaxedPath {
 public:
  RelaxedPath(Run& run, Attempt attempt);
  RelaxedPath(Run& run, Attempt attempt, PathProgress progress);

  /// Solves one problem after the other, each with barriers of the solver's choice, down to sigma = `until`.
  PathEnd follow(double until = 0.0);
  /// Solves the first problem so, those behind it in one loop of the solver, down to sigma = `until`. May be called
  /// again, to go on. Where the loop cannot solve a problem, and no branch is known, it goes back by one. From there
  /// it goes on once by the root of the factor of sigma. What it cannot solve so is solved, like those behind it, by
  /// itself.
  PathEnd loop(double until = 0.0);
  void show() { run_.relaxed = {std::move(relaxed_), std::move(at_.point), std::move(at_.report), at_.sigma}; }

  /// Null before the first one.
  [[nodiscard]] const std::optional<SolvedPoint>& last_solved() const { return at_.solved; }
  [[nodiscard]] double objective() const { return at_.objective; }  ///< of the last point, the user's
  [[nodiscard]] const PathProgress& progress() const { return at_; }

 private:
  [[nodiscard]] std::optional<PathEnd> end_at(bool is_last, int failures);
  [[nodiscard]] double infeasibility_of(const linalg::Vector& w);
  [[nodiscard]] bool has_settled() const;
  [[nodiscard]] bool is_nearly_done() const;
  [[nodiscard]] NlpPoint start(NlpOptions& options);
  void set_level(const homotopy::Level& level);
  void move_to(double sigma);
  void move_back();
  bool solve(double sigma, std::optional<double> tolerance = std::nullopt, int iteration_limit = 500);
  bool take(const NlpPoint& point, const NlpReport& report);
  PathEnd run_loop(double until, PathProgress& solved);
  PathEnd follow_from(double sigma, double until = 0.0);

  Run& run_;
  Attempt attempt_;
  Crossing crossing_;
  std::unique_ptr<homotopy::RelaxedProblem> relaxed_;
  homotopy::Schedule schedule_;  ///< of the loop
  PathProgress at_;
  double started_ = 0.0;  ///< seconds of the run at the last move
  bool is_in_loop_ = false;
};

/// Follows the paths of relaxed problems that can be compared, then others where those fail, until one ends.
///
/// Compared are two first sigmas, from the given start and from others, and random starts where the options want them.
/// Without those, others count where they cost less, or where no path from the given one is solved down to the compared
/// sigma. The path of the lowest objective goes on, until none is below the best branch. If all fail: the motion of the
/// first controls, if it is as good as the last relaxed point; from the start of the best one, one problem after the
/// other; the same from a smaller sigma; and elastic problems, from the last one that it solved.
[[nodiscard]] PathEnd follow_paths(Run& run, const Start& start, const std::vector<mpcc::NamedStart>& others);

}  // namespace saltus::solver
