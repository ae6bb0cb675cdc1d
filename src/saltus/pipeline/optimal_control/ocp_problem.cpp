#include "saltus/pipeline/optimal_control/ocp_problem.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/optimal_control/ocp_guess.hpp"
#include "saltus/pipeline/optimal_control/state_rows_internal.hpp"
#include "saltus/pipeline/options/element_choices_internal.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::pipeline {
namespace {

Error refusal(std::string message, std::string remedy) {
  Error error;
  error.code = ErrorCode::invalid_option;
  error.message = std::move(message);
  error.remedy = std::move(remedy);
  error.context.emplace_back("in [optimize]");
  return error;
}

Expected<std::vector<int>> elements_of(const OptimizeOptions& options) {
  const long intervals = options.control_intervals;
  if (intervals < 1) return tl::unexpected(refusal("control_intervals is missing", "give a whole number >= 1"));
  const auto& stated = options.elements;
  if (stated.size() != 1 && static_cast<long>(stated.size()) != intervals) {
    return tl::unexpected(
        refusal(fmt::format("elements lists {} numbers for {} control intervals", stated.size(), intervals),
                "give one number, or one per interval"));
  }
  std::vector<int> elements;
  for (long k = 0; k < intervals; ++k) {
    elements.push_back(static_cast<int>(stated.size() == 1 ? stated.front() : stated[static_cast<std::size_t>(k)]));
    if (elements.back() < 1) return tl::unexpected(refusal("elements has to be >= 1", "give whole numbers >= 1"));
  }
  return elements;
}

/// More equations than there are choices have no solution, or depend on each other: no method can tell which.
std::optional<Error> check_freedom(const model::Ocp& ocp, const std::vector<int>& elements,
                                   const OptimizeOptions& options) {
  const auto count = [](const std::vector<bool>& is_free) { return std::count(is_free.begin(), is_free.end(), true); };
  const auto intervals = std::ssize(elements);
  const auto copies = std::count_if(ocp.initial_values.begin(), ocp.initial_values.end(),
                                    [&](const auto& one) { return ocp.free_states[at(one.state)]; });
  const auto freedom = intervals * ocp.user_controls + count(ocp.free_states) + count(ocp.free_parameters) - copies +
                       (ocp.horizon.free ? 1 : 0) +
                       (ocp.clock && ocp.clock->speed_lower < ocp.clock->speed_upper ? intervals : 0);
  std::vector<std::string> named;
  const auto add = [&](const std::vector<model::OcpConstraint>& constraints, std::ptrdiff_t points) {
    std::ptrdiff_t rows = 0;
    for (const auto& constraint : constraints) {
      if (constraint.norm != model::ConstraintNorm::hard || constraint.lower != constraint.upper) continue;
      named.push_back(points == 1 ? fmt::format("'{}'", constraint.name)
                                  : fmt::format("'{}' at {} points", constraint.name, points));
      rows += points;
    }
    return rows;
  };
  auto points = intervals;
  if (ocp.path_at != model::ConstraintPoints::intervals) points = std::accumulate(elements.begin(), elements.end(), 0);
  if (ocp.path_at == model::ConstraintPoints::stages) points *= options.element.stages;
  const auto equations = add(ocp.terminal, 1) + add(ocp.path, points);
  if (equations <= freedom) return std::nullopt;
  return refusal(
      fmt::format("there are {} equality constraints and only {} values to choose (controls, what is free): {}",
                  equations, freedom, fmt::join(named, ", ")),
      "leave some out, state them as inequalities, soften them ({ constraint = ..., norm = \"l1\" }), or use more "
      "control_intervals");
}

discretization::FesdOptions discretization_options(const OptimizeOptions& options) {
  auto chosen = fesd_options(options.element);
  if (!options.switch_detection) {
    chosen.cross_complementarity = discretization::CrossComplementarity::same_stage;
    chosen.step_equilibration = discretization::StepEquilibration::none;
  }
  return chosen;
}

/// Of the states, those that results have: all, or without the hidden ones of frozen time.
std::vector<std::string> result_states(const model::System& system) {
  auto names = system.state_names;
  if (system.freezing) names.resize(at(system.freezing->first_hidden));
  return names;
}

/// A start from a stored result of the same model, possibly with another number of intervals.
Expected<void> take_result(const model::Ocp& ocp, const result::Result& from, int intervals,
                           const std::vector<double>& fractions, discretization::OcpGuessValues& guess) {
  const auto names = [](const std::vector<std::string>& list) { return fmt::format("{}", fmt::join(list, ", ")); };
  const std::vector<std::string> controls(ocp.system.control_names.begin(),
                                          ocp.system.control_names.begin() + ocp.user_controls);
  const auto states = result_states(ocp.system);
  if (from.states != states || from.controls != controls) {
    return tl::unexpected(
        refusal(fmt::format("the result to start from belongs to another model: it has the states {} "
                            "and the controls {}",
                            names(from.states), names(from.controls)),
                fmt::format("this model has the states {} and the controls {}", names(states), names(controls))));
  }
  if (from.kept) {
    return tl::unexpected(refusal("the result to start from has not kept all states in its rows",
                                  "simulate it again without `states` in its output"));
  }
  if (from.trajectory.t.empty()) return {};
  const double begin = from.trajectory.t.front();
  const double length = from.trajectory.t.back() - begin;
  if (ocp.horizon.free) guess.horizon = std::clamp(length, ocp.horizon.lower, ocp.horizon.upper);
  guess.initial_state = with_hidden_states(ocp.system, from.trajectory.x.front(), begin);
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const double t = begin + fractions[i] * length;
    guess.states[i] = with_hidden_states(ocp.system, row_at(from.trajectory.t, from.trajectory.x, t), t);
  }
  for (int k = 0; k < intervals && !from.trajectory.u.empty(); ++k) {
    const double middle = begin + length * (k + 0.5) / intervals;
    const auto behind = std::upper_bound(from.trajectory.t.begin(), from.trajectory.t.end(), middle);
    const auto row = static_cast<std::size_t>(std::max<std::ptrdiff_t>(behind - from.trajectory.t.begin() - 1, 0));
    const auto& u = from.trajectory.u[row];
    std::copy(u.begin(), u.end(), guess.controls[at(k)].begin());
  }
  for (const auto& [name, value] : from.model.parameters) {
    const auto& known = ocp.system.parameter_names;
    const auto found = std::find(known.begin(), known.end(), name);
    const auto i = static_cast<std::size_t>(found - known.begin());
    if (found != known.end() && ocp.free_parameters[i]) guess.parameters[i] = value;
  }
  return {};
}

/// The problem whose point a stored result is; null where it is none of this kernel.
std::unique_ptr<discretization::OcpProblem> stored_problem(const model::Ocp& ocp, const reformulation::Dcs& dcs,
                                                           const std::shared_ptr<discretization::OcpKernel>& kernel,
                                                           const result::Optimization& stored) {
  std::vector<int> elements;
  for (const auto& lengths : stored.h) elements.push_back(static_cast<int>(lengths.size()));
  const bool has_samples = std::any_of(ocp.least_squares.begin(), ocp.least_squares.end(),
                                       [&](const auto& term) { return term.samples_per_interval() > 0; });
  if (elements.empty() || has_samples) return nullptr;
  auto problem = discretization::OcpProblem::make(kernel, ocp, dcs, elements);
  const bool fits = problem && std::ssize(stored.primal) == (*problem)->variables();
  return fits ? std::move(*problem) : nullptr;
}

/// What time froze is in the elements of a stored result, not in its rows.
void take_elements(const model::Ocp& ocp, const reformulation::Dcs& dcs,
                   const std::shared_ptr<discretization::OcpKernel>& kernel, const result::Result& from,
                   discretization::OcpProblem& problem) {
  if (!from.optimization) return;
  const auto& primal = from.optimization->primal;
  const auto stored = stored_problem(ocp, dcs, kernel, *from.optimization);
  if (!stored) return;
  problem.set_start(*stored, primal);
}

}  // namespace

Expected<StatedProblem> state_problem(const model::Ocp& ocp, const OptimizeOptions& options) {
  auto elements = elements_of(options);
  if (!elements) return tl::unexpected(elements.error());
  if (auto error = check_freedom(ocp, *elements, options)) return tl::unexpected(std::move(*error));
  auto tableau = discretization::butcher_tableau(options.element.scheme, static_cast<int>(options.element.stages));
  if (!tableau) return tl::unexpected(tableau.error());
  auto reformulated = reformulation::reformulate(ocp.system, reformulation_options(options.element));
  if (!reformulated) return tl::unexpected(reformulated.error());
  const auto dcs = std::make_shared<const reformulation::Dcs>(std::move(*reformulated));
  auto kernel = discretization::OcpKernel::compile(ocp, *dcs, *tableau, discretization_options(options),
                                                   native_code(options.native));
  if (!kernel) return tl::unexpected(kernel.error());
  auto problem = discretization::OcpProblem::make(*kernel, ocp, *dcs, *elements);
  if (!problem) return tl::unexpected(problem.error());

  const auto fractions = (*problem)->start_fractions();
  const int intervals = static_cast<int>(elements->size());
  auto begin = guess_start(ocp, intervals, fractions);
  if (!begin) return tl::unexpected(begin.error());
  discretization::OcpGuessValues guess{.horizon = begin->horizon,
                                       .parameters = std::move(begin->parameters),
                                       .controls = std::move(begin->controls),
                                       .initial_state = std::move(begin->initial_state),
                                       .states = std::move(begin->states),
                                       .has_modes = options.mpcc.first == solver::FirstProblem::modes,
                                       .simulated = options.start == StartValues::simulated};
  if (options.start_from) {
    auto taken = take_result(ocp, *options.start_from, intervals, fractions, guess);
    if (!taken) return tl::unexpected(taken.error());
  }
  for (const auto& [state, parameter] : ocp.initial_values)
    guess.parameters[at(parameter)] = guess.initial_state[at(state)];
  (*problem)->set_start(guess);
  if (options.start_from) {
    take_elements(ocp, *dcs, *kernel, *options.start_from, **problem);
  } else {
    guess.simulated = true;
    (*problem)->add_start("selections by the signs of the guessed states", guess);
    guess.simulated = options.start == StartValues::simulated;
    for (auto& [name, states] : begin->others) {
      guess.states = std::move(states);
      (*problem)->add_start(std::move(name), guess);
    }
  }
  if (const auto name = (*problem)->not_finite((*problem)->start()); !name.empty()) {
    auto error = refusal(fmt::format("{} is not finite at the initial guess", name),
                         "give an initial_guess at which costs and constraints are defined");
    error.code = ErrorCode::invalid_model;
    return tl::unexpected(std::move(error));
  }
  return StatedProblem{dcs,
                       std::move(*kernel),
                       std::move(*elements),
                       std::move(*problem),
                       std::move(*tableau),
                       std::move(begin->warnings)};
}

}  // namespace saltus::pipeline
