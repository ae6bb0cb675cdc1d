#include <algorithm>
#include <utility>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/ocp_guess.hpp"
#include "saltus/pipeline/optimal_control/state_rows_internal.hpp"
#include "saltus/pipeline/optimal_control/stepped_start_internal.hpp"
#include "saltus/time_stepping/stepped_ocp.hpp"

namespace saltus::pipeline {
namespace {

/// What is left of complementarity is less than the error of a step.
constexpr double last_sigma = 1e-6;
/// Of constraints, for the same reason.
constexpr double feasible = 1e-3;
constexpr int most_of_steps = 1500;  // iterations of all starts together
/// So large that motions hardly know of contacts, and so small that they stay near their start.
constexpr double large_sigma = 1.0, small_sigma = 0.01;

/// Without the hidden states of frozen time.
std::vector<double> shown(std::vector<double> x, const model::Ocp& ocp) {
  x.resize(ocp.physical->state_names.size());
  return x;
}

result::HomotopyStep named(result::HomotopyStep step) {
  step.message = step.message.empty() ? "time stepping" : "time stepping: " + step.message;
  return step;
}

/// Where a path begins.
struct Beginning {
  linalg::Vector w;
  double sigma = 1.0;
};

/// Each order of collisions has optima of its own: the lowest one.
std::optional<solver::Solution> best_of(const std::vector<Beginning>& beginnings, mpcc::Problem& problem,
                                        solver::SolveOptions wanted, solver::Solution& record) {
  wanted.on_step = [tell = wanted.on_step](const result::HomotopyStep& step) { tell(named(step)); };
  adapters::IpoptSolver ipopt(adapters::linear_solver_of(wanted.strategy));
  adapters::HighsLpcc highs;
  const Stopwatch clock;
  std::optional<solver::Solution> best;
  int left = std::min(wanted.iteration_limit, most_of_steps);
  for (const auto& [w, sigma] : beginnings) {
    if (wanted.is_interrupted() || left <= 0) break;
    solver::SolveOptions one = wanted;
    one.iteration_limit = left;
    one.sigma_initial = sigma;
    one.time_limit = solver::time_left(wanted, clock.seconds());
    auto solution = solver::solve(problem, ipopt, highs, one, solver::Start{.w = w, .multipliers = {}});
    if (!solution) continue;
    for (const auto& step : solution->homotopy) record.homotopy.push_back(named(step));
    record.iterations += solution->iterations;
    left -= solution->iterations;
    record.evaluation_seconds += solution->evaluation_seconds;
    record.solver_seconds += solution->solver_seconds;
    const auto& of = solution->certificate;
    const bool is_feasible = of.primal_infeasibility <= feasible && of.complementarity_residual <= feasible;
    if (is_feasible && !(best && solution->objective >= best->objective)) best = std::move(*solution);
  }
  return best;
}

}  // namespace

std::optional<SteppedStart> stepped_start(const model::Ocp& ocp, const OptimizeOptions& options,
                                          solver::SolveOptions wanted, const std::vector<double>& fractions,
                                          solver::Solution& record) {
  if (!ocp.physical) return std::nullopt;
  const int intervals = static_cast<int>(options.control_intervals);
  std::vector<double> times = time_stepping::ends_of_steps(intervals);  // fractions of the horizon
  const auto begin = guess_start(ocp, intervals, times);
  if (!begin) return std::nullopt;
  time_stepping::Motion guess{.horizon = begin->horizon,
                              .parameters = begin->parameters,
                              .controls = begin->controls,
                              .initial_state = shown(begin->initial_state, ocp),
                              .states = {}};
  for (const auto& x : begin->states) guess.states.push_back(shown(x, ocp));
  const auto stepped = time_stepping::SteppedOcp::make(ocp, intervals, guess);
  if (!stepped) return std::nullopt;
  wanted.crossover = false;
  wanted.schedule.sigma_final = last_sigma;
  wanted.compared_starts = 0;
  wanted.starts = 1;
  wanted.make_workplace = {};
  const linalg::Vector w = stepped->problem().start();
  std::vector<Beginning> beginnings{{w, large_sigma}, {w, small_sigma}};
  for (const auto& [name, states] : begin->others) beginnings.push_back({stepped->start_at(states), small_sigma});
  const auto solution = best_of(beginnings, stepped->problem(), std::move(wanted), record);
  if (!solution) return std::nullopt;
  auto motion = stepped->read(solution->w);
  const auto with_clock = [&](std::vector<double> x, double fraction) {
    return with_hidden_states(ocp.system, std::move(x), ocp.from + fraction * motion.horizon);
  };
  discretization::OcpGuessValues found{.horizon = motion.horizon,
                                       .parameters = std::move(motion.parameters),
                                       .controls = std::move(motion.controls),
                                       .initial_state = with_clock(motion.initial_state, 0.0),
                                       .states = {}};
  times.insert(times.begin(), 0.0);
  motion.states.insert(motion.states.begin(), std::move(motion.initial_state));
  for (const double fraction : fractions) {
    found.states.push_back(with_clock(row_at(times, motion.states, fraction), fraction));
  }
  return SteppedStart{std::move(found), solution->objective};
}

}  // namespace saltus::pipeline
