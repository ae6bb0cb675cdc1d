#include <algorithm>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/solver/exploration_internal.hpp"
#include "saltus/solver/workplaces_internal.hpp"

namespace saltus::solver {
namespace {

/// What one start has done.
struct Done {
  Explored explored;
  Solution solution;
  std::optional<result::Termination> stopped;
  bool is_infeasible = false;
};

SolveOptions options_of_one(const Run& run) {
  SolveOptions options = run.options;
  options.on_step = [](const result::HomotopyStep&) {};
  options.crossover = false;  // paths are compared first
  options.time_limit = time_left(run.options, run.seconds());
  return options;
}

Done one(const Place& place, SolveOptions options, const Attempt& start, double until) {
  options.is_interrupted = place.is_interrupted;
  Run run(place.problem, place.nlp, place.lpcc, options);
  place.problem.without_method_terms();
  RelaxedPath path(run, start);
  Done done;
  done.explored.end = path.loop(until);
  done.explored.progress = path.progress();
  done.solution = std::move(run.solution);
  done.stopped = run.stopped;
  done.is_infeasible = run.is_infeasible;
  return done;
}

}  // namespace

std::vector<Explored> explore(Run& run, const std::vector<Attempt>& starts, double until) {
  std::vector<Done> all(starts.size());
  const SolveOptions options = options_of_one(run);
  const auto is_given = [](const Attempt& start) { return start.name.empty(); };
  const auto given = static_cast<int>(std::count_if(starts.begin(), starts.end(), is_given));
  SolveOptions of_given = options;
  if (given > 1) of_given.iteration_limit /= given;
  const auto task = [&](int i, const Place& place) {
    const Attempt& start = starts[at(i)];
    all[at(i)] = one(place, is_given(start) ? of_given : options, start, until);
  };
  share_out({run.problem, run.nlp, run.lpcc}, options, static_cast<int>(starts.size()), task);
  std::vector<Explored> explored;
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto& [end, solution, stopped, is_infeasible] = all[i];
    if (!is_given(starts[i])) run.iteration_limit += solution.iterations;
    run.add(solution);
    run.is_infeasible = run.is_infeasible || is_infeasible;
    const bool is_unbounded = stopped == result::Termination::not_converged;
    run.is_diverging = run.is_diverging || is_unbounded;
    if (is_unbounded || stopped == result::Termination::stopped_by_user) run.stopped = stopped;
    explored.push_back(std::move(end));
  }
  return explored;
}

}  // namespace saltus::solver
