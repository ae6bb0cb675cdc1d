// Simulation steps by their problem with complementarities; its elements are solved again with their active sets.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/run_internal.hpp"
#include "saltus/fesd_integrator/step_problem.hpp"

namespace saltus::fesd_integrator {
namespace {

/// A step without a solution is halved at most so often: each try costs hundreds of iterations.
constexpr int most_halvings_of_step = 10;
/// Where active sets have failed there is seldom a solution at all.
constexpr int most_halvings_of_fallback = 2;

}  // namespace

bool Run::solve_guessed(const std::vector<ElementGuess>& guesses, std::vector<ActiveSet>& sets) {
  sets.clear();
  chain_.left[0] = selections_;
  Point left{t_, x_, selections_, size_};
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    const auto& guess = guesses[i];
    sets.emplace_back(facts_.parts, guess.modes);
    auto& element = chain_.elements[i];
    if (i == 0 || !(sets[i] == sets[i - 1])) selections_behind(guess, sets[i], left);
    const auto outcome =
        solver_.solve(left, guess.h, {&sets[i], 1}, held_.data(), ElementSolver::Guess::left_end, element);
    chain_.determined[i] = solver_.determined();
    Violation ignored;  // signs hold at the stages and at both ends, which is all the problem knows of
    auto& right = chain_.left[i + 1];
    right = left.selections;
    if (outcome != ElementSolver::Outcome::solved ||
        watch_.look(element, sets[i], held_.data(), right, ignored) == Watch::Answer::not_finite) {
      return false;
    }
    left = {left.t + guess.h, element.end, right, element.size};
  }
  chain_.count = guesses.size();
  return true;
}

/// The selections just behind a change of the active set.
void Run::selections_behind(const ElementGuess& guess, const ActiveSet& set, Point& left) {
  for (std::size_t j = 0; j < left.selections.size(); ++j) {
    left.selections[j] = guess.selections(static_cast<Eigen::Index>(j), 0);
  }
  if (set.sliding().empty()) return;
  between_selections_ = left.selections;
  if (projected_.solve(left.t, left.x.data(), set, held_.data(), between_selections_.data())) {
    left.selections = between_selections_;
  }
}

void Run::accept_guessed(const std::vector<ElementGuess>& guesses, const std::vector<ActiveSet>& sets, double end) {
  for (std::size_t i = 0; i < guesses.size() && !stopped(); ++i) {
    const Element& element = chain_.elements[i];
    if (!(sets[i] == set_)) {
      const ActiveSet before = set_;
      const auto selections = selections_;
      Point behind{t_, x_, selections_, size_};
      selections_behind(guesses[i], sets[i], behind);
      const std::vector<Continuation> found{{sets[i], behind.selections, chain_.determined[i]}};
      recorder_.switched(t_, x_, {&before, &selections, held_.data()}, found, held_.data(),
                         "found by the problem of the step");
      continue_with(found);
      fire_events_here();
    }
    accept(element, selections_, chain_.left[i + 1], i + 1 == guesses.size() ? end : element.t + element.h);
    row_here();
  }
}

std::optional<std::string> Run::steep_here() {
  kernel_.evaluate(t_, x_.data(), selections_.data(), held_.data(), at_switch_);
  const std::size_t n_x = x_.size();
  // Of a square root: of arguments below 1e-20 of the unit of time.
  constexpr double steep = 1e10;
  for (std::size_t k = 0; k < n_x; ++k) {
    for (std::size_t i = 0; i < n_x; ++i) {
      const double derivative = at_switch_.f_x[k * n_x + i];
      if (std::abs(derivative) * nominal_ < steep) continue;
      return fmt::format(
          "the right-hand side of {} has no finite derivative by {} at t = {:.10g} (a root of zero?), and elements are "
          "solved by derivatives; use method = \"event\"",
          facts_.state_names[i], facts_.state_names[k], t_);
    }
  }
  const std::size_t n = facts_.selections.size();
  for (std::size_t k = 0; k < n_x; ++k) {
    for (std::size_t j = 0; j < n; ++j) {
      // Of any size, as psi may be in any unit.
      if (std::isfinite(at_switch_.indicator_x[k * n + j])) continue;
      return fmt::format(
          "the switching function of {} has no finite derivative by {} at t = {:.10g} (a root of zero?), and elements "
          "are solved by derivatives; use method = \"event\"",
          facts_.selections[j].name, facts_.state_names[k], t_);
    }
  }
  return std::nullopt;
}

void Run::fall_back(double end, result::Termination termination, std::string message) {
  auto reason = steep_here();
  if (!reason) reason = undefined_beyond();
  if (reason) {
    stop(result::Termination::evaluation_failed, std::move(*reason));
    return;
  }
  StepProblem* problem = can_fall_back() ? options_.fallback() : nullptr;
  if (problem == nullptr) {
    stop(termination, std::move(message) + "; more simulate.fesd.steps, or method = \"event\"");
    return;
  }
  previous_.reset();
  advance_by_problem(*problem, end, most_halvings_of_fallback);
  previous_.reset();
}

void Run::advance_by_problem(StepProblem& problem, double end) {
  advance_by_problem(problem, end, most_halvings_of_step);
}

void Run::advance_by_problem(StepProblem& problem, double end, int halvings_allowed) {
  double limit = end;
  int halvings = 0;
  std::vector<ActiveSet> sets;
  while (!stopped() && t_ < end) {
    const std::vector<double> held(held_.data(), held_.data() + facts_.held.size());
    const StepSolution solution = problem.solve({.t = t_, .length = limit - t_, .x = x_, .held = held});
    if (!solution.elements.empty() && solve_guessed(solution.elements, sets)) {
      accept_guessed(solution.elements, sets, limit);
      limit = end;
      halvings = 0;
      continue;
    }
    reject();
    if (stopped()) return;
    limit = t_ + 0.5 * (limit - t_);
    if (++halvings <= halvings_allowed) continue;
    stop(solution.elements.empty() ? solution.termination : result::Termination::not_converged,
         fmt::format(
             "the problem with complementarities of the step at t = {:.10g} has no solution that was found ({}); "
             "more simulate.fesd.steps, or method = \"event\"",
             t_, solution.message.empty() ? "its elements cannot be solved again" : solution.message));
  }
}

}  // namespace saltus::fesd_integrator
