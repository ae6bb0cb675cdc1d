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
constexpr int most_of_steps = 1500;  // iterations of all starts together, and again of all shorter horizons
/// Of a free horizon: the next one that is tried.
constexpr double shorter = 0.9;
/// So large that motions hardly know of contacts, and so small that they stay near their start.
constexpr double large_sigma = 1.0, small_sigma = 0.01;
/// So small that modes stay.
constexpr double least_sigma = 1e-4;

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

/// Follows paths one after the other, as long as iterations and time are left.
class Paths {
 public:
  Paths(solver::SolveOptions wanted, solver::Solution& record)
      : wanted_(std::move(wanted)), record_(record), left_in_all_(wanted_.iteration_limit) {
    allow_more();
    wanted_.on_step = [tell = wanted_.on_step](const result::HomotopyStep& step) { tell(named(step)); };
  }

  /// From here on `most_of_steps` iterations, as far as the limit of all goes.
  void allow_more() { left_ = std::min(left_in_all_, most_of_steps); }

  [[nodiscard]] bool are_over() const { return left_ <= 0 || solver::is_over(wanted_, clock_.seconds()); }

  /// Each order of collisions has optima of its own: returns the lowest one.
  std::optional<solver::Solution> best_of(const std::vector<Beginning>& beginnings, mpcc::Problem& problem) {
    std::optional<solver::Solution> best;
    for (const auto& beginning : beginnings) {
      auto solution = follow(beginning, problem);
      if (solution && !(best && solution->objective >= best->objective)) best = std::move(solution);
    }
    return best;
  }

 private:
  /// Nothing where that leads to no motion.
  std::optional<solver::Solution> follow(const Beginning& beginning, mpcc::Problem& problem) {
    if (are_over()) return std::nullopt;
    solver::SolveOptions one = wanted_;
    one.iteration_limit = left_;
    one.sigma_initial = beginning.sigma;
    one.time_limit = solver::time_left(wanted_, clock_.seconds());
    auto solution = solver::solve(problem, ipopt_, highs_, one, solver::Start{.w = beginning.w, .multipliers = {}});
    if (!solution) return std::nullopt;
    for (auto& step : solution->homotopy) step = named(std::move(step));
    add_path(*solution, record_);
    left_ -= solution->iterations;
    left_in_all_ -= solution->iterations;
    const auto& of = solution->certificate;
    const bool is_feasible = of.primal_infeasibility <= feasible && of.complementarity_residual <= feasible;
    return is_feasible ? std::optional(std::move(*solution)) : std::nullopt;
  }

  solver::SolveOptions wanted_;
  solver::Solution& record_;
  int left_in_all_, left_ = 0;  ///< iterations
  adapters::IpoptSolver ipopt_{adapters::linear_solver_of(wanted_.strategy)};
  adapters::HighsLpcc highs_;
  Stopwatch clock_;
};

/// Relaxed problems shorten a free horizon until no motion is left, and lead nowhere from there. So motions of a
/// horizon that is held come first, from which it is let go where hardly anything is relaxed; then shorter ones, as
/// long as there are any.
std::optional<solver::Solution> shortened(const model::Ocp& ocp, int intervals, time_stepping::Motion guess,
                                          const time_stepping::SteppedOcp& stepped, Paths& paths) {
  paths.allow_more();
  std::optional<solver::Solution> best;
  linalg::Vector w = stepped.problem().start();
  for (; guess.horizon >= ocp.horizon.lower && !paths.are_over(); guess.horizon *= shorter) {
    const auto held = time_stepping::SteppedOcp::make(ocp, intervals, guess, true);
    const auto motion = paths.best_of({{w, large_sigma}}, held->problem());
    auto found = motion ? paths.best_of({{motion->w, least_sigma}}, stepped.problem()) : std::nullopt;
    if (!found || (best && found->objective >= best->objective)) break;
    guess.horizon = stepped.read(found->w).horizon;
    w = found->w;
    best = std::move(found);
  }
  return best;
}

}  // namespace

void add_path(const solver::Solution& solution, solver::Solution& record) {
  record.homotopy.insert(record.homotopy.end(), solution.homotopy.begin(), solution.homotopy.end());
  record.iterations += solution.iterations;
  record.evaluation_seconds += solution.evaluation_seconds;
  record.solver_seconds += solution.solver_seconds;
}

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
  Paths paths(wanted, record);
  auto solution = paths.best_of(beginnings, stepped->problem());
  if (!solution && ocp.horizon.free) solution = shortened(ocp, intervals, guess, *stepped, paths);
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
