// Simulation steps by their problem with complementarities; its elements are solved again with their active sets.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/fesd_integrator/run/diagnosis_internal.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"
#include "saltus/fesd_integrator/step_problem.hpp"

namespace saltus::fesd_integrator {
namespace {

/// A step without a solution is halved at most so often: each try costs hundreds of iterations.
constexpr int most_halvings_of_step = 10;
/// Where active sets have failed there is seldom a solution at all.
constexpr int most_halvings_of_fallback = 2;

}  // namespace

bool Run::solve_guessed(const std::vector<ElementGuess>& guesses, Guessed& guessed) {
  guessed = {};
  chain_.left()[0] = position_.selections();
  Point left = position_.left_end();
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    const auto& guess = guesses[i];
    guessed.sets.emplace_back(context_.facts.parts, guess.modes);
    const ActiveSet& set = guessed.sets[i];
    auto& element = chain_.element(i);
    if (i == 0 || !(set == guessed.sets[i - 1])) selections_behind(guess, set, left);
    const auto outcome =
        context_.solver.solve(left, guess.h, {&set, 1}, context_.held.data(), ElementSolver::Guess::left_end, element);
    guessed.determined.push_back(context_.solver.determined());
    Violation ignored;  // signs hold at the stages and at both ends, which is all the problem knows of
    auto& right = chain_.left()[i + 1];
    right = left.selections;
    if (outcome != ElementSolver::Outcome::solved ||
        context_.watch.look(element, set, context_.held.data(), right, ignored) == Watch::Answer::not_finite) {
      return false;
    }
    left = {left.t + guess.h, element.end, right, element.size};
  }
  chain_.set_count(guesses.size());
  return true;
}

/// The selections just behind a change of the active set.
void Run::selections_behind(const ElementGuess& guess, const ActiveSet& set, Point& left) {
  for (std::size_t j = 0; j < left.selections.size(); ++j) {
    left.selections[j] = guess.selections(static_cast<linalg::Index>(j), 0);
  }
  if (set.sliding().empty()) return;
  auto held_on = left.selections;
  if (context_.projected.solve(left.t, left.x.data(), set, context_.held.data(), held_on.data()))
    left.selections = held_on;
}

void Run::accept_guessed(const std::vector<ElementGuess>& guesses, const Guessed& guessed, double end) {
  for (std::size_t i = 0; i < guesses.size() && !stopped(); ++i) {
    const Element& element = chain_.element(i);
    const ActiveSet& set = guessed.sets[i];
    if (!(set == position_.set())) {
      const Before before = before_here();
      Point behind = position_.left_end();
      selections_behind(guesses[i], set, behind);
      const std::vector<Continuation> found{{set, behind.selections, guessed.determined[i]}};
      recorder_.switched(position_.t(), position_.x(), {&before.set, &before.selections, context_.held.data()}, found,
                         context_.held.data(), "found by the problem of the step");
      continue_with(found);
      events_.fire_at_switch();
    }
    accept(element, position_.selections(), chain_.left()[i + 1],
           i + 1 == guesses.size() ? end : element.t + element.h);
    rows_.emit_here();
  }
}

void Run::fall_back(double end, result::Termination termination, std::string message) {
  auto reason = steep_derivative(context_, position_, length_.nominal());
  if (!reason) reason = undefined_beyond(context_, position_, length_.nominal());
  if (reason) {
    stop(result::Termination::evaluation_failed, std::move(*reason));
    return;
  }
  StepProblem* problem = can_fall_back() ? context_.options.fallback() : nullptr;
  if (problem == nullptr) {
    stop(termination, std::move(message) + "; more simulate.fesd.steps, or method = \"event\"");
    return;
  }
  chain_.interrupt();
  advance_by_problem(*problem, end, most_halvings_of_fallback);
  chain_.interrupt();
}

void Run::advance_by_problem(StepProblem& problem, double end) {
  advance_by_problem(problem, end, most_halvings_of_step);
}

void Run::advance_by_problem(StepProblem& problem, double end, int halvings_allowed) {
  double limit = end;
  int halvings = 0;
  Guessed guessed;
  while (!stopped() && position_.t() < end) {
    const std::vector<double> held(context_.held.data(), context_.held.data() + context_.facts.held.size());
    const StepSolution solution =
        problem.solve({.t = position_.t(), .length = limit - position_.t(), .x = position_.x(), .held = held});
    if (!solution.elements.empty() && solve_guessed(solution.elements, guessed)) {
      accept_guessed(solution.elements, guessed, limit);
      limit = end;
      halvings = 0;
      continue;
    }
    reject();
    if (stopped()) return;
    limit = position_.t() + 0.5 * (limit - position_.t());
    if (++halvings <= halvings_allowed) continue;
    stop(solution.elements.empty() ? solution.termination : result::Termination::not_converged,
         fmt::format(
             "the problem with complementarities of the step at t = {:.10g} has no solution that was found ({}); "
             "more simulate.fesd.steps, or method = \"event\"",
             position_.t(), solution.message.empty() ? "its elements cannot be solved again" : solution.message));
  }
}

}  // namespace saltus::fesd_integrator
