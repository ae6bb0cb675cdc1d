#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/base/at.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/pipeline/optimal_control/solve_ocp_internal.hpp"
#include "saltus/pipeline/optimal_control/stepped_start_internal.hpp"

namespace saltus::pipeline {
namespace {

using result::Termination;

/// Times that intervals may get an element more.
constexpr int most_rounds = 3;
/// Of controls that time stepping finds, one after the other: each has other modes.
constexpr int most_motions = 4;
/// Of the objective of time stepping, relative.
constexpr double error_of_steps = 0.05;
/// Of the objective: by less an element more is not worth it.
constexpr double worth_an_element = 1e-4;

linalg::Vector vector_of(const std::vector<double>& values) { return linalg::ConstView(values); }

std::optional<solver::Start> same_structure(const discretization::OcpProblem& problem, const OptimizeOptions& options) {
  if (!options.start_from || !options.start_from->optimization) return std::nullopt;
  const auto& from = *options.start_from->optimization;
  if (static_cast<int>(from.primal.size()) != problem.variables()) return std::nullopt;
  solver::Start start;
  start.w = vector_of(from.primal);
  if (static_cast<int>(from.dual_rows.size()) != problem.constraints()) return start;
  start.multipliers.rows = vector_of(from.dual_rows);
  start.multipliers.lower = vector_of(from.dual_lower);
  start.multipliers.upper = vector_of(from.dual_upper);
  return start;
}

/// The same problem in a kernel of its own: one thread at a time uses a kernel.
std::optional<solver::Workplace> another_place(const model::Ocp& ocp, const OptimizeOptions& options) {
  auto stated = state_problem(ocp, options);
  if (!stated) return std::nullopt;
  return solver::Workplace{std::move(stated->problem),
                           std::make_unique<adapters::IpoptSolver>(adapters::linear_solver_of(options.mpcc.strategy)),
                           std::make_unique<adapters::HighsLpcc>()};
}

/// The path of both, and the point of the second one.
void go_on_with(solver::Solution next, solver::Solution& solution) {
  next.homotopy.insert(next.homotopy.begin(), solution.homotopy.begin(), solution.homotopy.end());
  next.iterations += solution.iterations;
  next.starts = std::move(solution.starts);
  next.evaluation_seconds += solution.evaluation_seconds;
  next.solver_seconds += solution.solver_seconds;
  solution = std::move(next);
}

/// The certificate of a solution is one of so many elements. Another one may take as long as the first.
class MoreElements {
 public:
  MoreElements(const model::Ocp& ocp, solver::SolveOptions options, SolvedOcp& solved)
      : ocp_(ocp), limits_(std::move(options)), options_(limits_), solved_(solved) {
    options_.first = solver::FirstProblem::branch;
    options_.starts = 1;
    options_.seed.reset();
    options_.compared_starts = 0;
    options_.make_workplace = {};  // they have other elements
  }

  /// @return whether there are intervals that are better with an element more; they have it
  [[nodiscard]] bool add() {
    auto& [stated, solution, has_more, seconds, distance] = solved_;
    options_.iteration_limit = std::min(solution.iterations, limits_.iteration_limit - solution.iterations);
    if (solution.termination != Termination::completed || options_.iteration_limit < 1) return false;
    if (solver::is_over(limits_, clock_.seconds())) return false;
    options_.time_limit = solver::time_left(limits_, clock_.seconds());
    const auto crowded = stated.problem->crowded_intervals(solution.w, solution.multipliers.upper, options_.tolerance);
    if (crowded.empty()) return false;
    auto elements = stated.elements;
    for (const int k : crowded) ++elements[at(k)];
    auto problem = discretization::OcpProblem::make(stated.kernel, ocp_, *stated.dcs, elements);
    if (!problem) return false;
    (*problem)->set_start(*stated.problem, solution.w);
    auto next = solver::solve(**problem, ipopt_, highs_, options_);
    if (!next || next->termination != Termination::completed) return false;
    const double least = worth_an_element * std::max(1.0, std::abs(solution.objective));
    if (!(next->objective < solution.objective - least)) return false;
    stated.elements = std::move(elements);
    stated.problem = std::move(*problem);
    go_on_with(std::move(*next), solution);
    return has_more = true;
  }

 private:
  const model::Ocp& ocp_;
  solver::SolveOptions limits_;  ///< of all solutions together
  solver::SolveOptions options_;
  SolvedOcp& solved_;
  Stopwatch clock_;
  adapters::IpoptSolver ipopt_{adapters::linear_solver_of(options_.strategy)};
  adapters::HighsLpcc highs_;
};

/// Whoever says how to begin gets that.
bool begins_freely(const OptimizeOptions& options) {
  const auto& wanted = options.mpcc;
  return options.start_from == nullptr && wanted.strategy == solver::Strategy::structured && wanted.crossover &&
         wanted.first == solver::FirstProblem::automatic && !wanted.sigma_initial && !wanted.seed &&
         !wanted.compared_starts && wanted.starts.value_or(1) == 1 && options.switch_detection;
}

/// A solution with the elements that its motion has needed.
struct FromSteps {
  solver::Solution solution;
  std::unique_ptr<discretization::OcpProblem> problem;
  std::vector<int> elements;
  bool is_as_good = false;  ///< as the steps
};

/// From a motion of the controls in w, with an element for each of its modes. Where its branch has no solution, these
/// modes cannot meet the constraints: the controls of the point that comes nearest have a motion of other modes.
std::optional<FromSteps> solve_motion_of(const model::Ocp& ocp, const solver::SolveOptions& wanted, linalg::Vector w,
                                         const StatedProblem& stated, solver::Solution& record) {
  const Stopwatch clock;
  const auto is_over = [&] { return solver::is_over(wanted, clock.seconds()); };
  solver::SolveOptions rest = wanted;
  rest.make_workplace = {};  // they have other elements
  adapters::IpoptSolver ipopt(adapters::linear_solver_of(wanted.strategy));
  adapters::HighsLpcc highs;
  FromSteps found;
  for (int motion_number = 0; motion_number < most_motions; ++motion_number) {
    auto& before = found.problem ? *found.problem : *stated.problem;
    const auto modes = before.motion_modes(w, is_over, true);
    if (!modes) return std::nullopt;
    found.elements = discretization::elements_of(*modes);
    for (std::size_t k = 0; k < found.elements.size(); ++k) {
      found.elements[k] = std::max(found.elements[k], stated.elements[k]);
    }
    auto problem = discretization::OcpProblem::make(stated.kernel, ocp, *stated.dcs, found.elements);
    if (!problem) return std::nullopt;
    (*problem)->set_start(before, w);
    found.problem = std::move(*problem);
    const auto motion = found.problem->motion(found.problem->start(), *modes);
    if (!motion) return std::nullopt;
    rest.time_limit = solver::time_left(wanted, clock.seconds());
    found.solution = solver::solve_motion(*found.problem, ipopt, highs, rest, *motion);
    if (found.solution.termination == Termination::completed) return found;
    if (found.solution.crossed_over) return std::nullopt;  // a solution that nothing certifies
    add_path(found.solution, record);
    w = std::move(found.solution.w);
  }
  return std::nullopt;
}

/// From the motion of the controls that time stepping finds. Nothing where that leads to no solution. Its states are
/// one more start.
std::optional<FromSteps> solve_from_steps(const model::Ocp& ocp, const OptimizeOptions& options,
                                          const solver::SolveOptions& wanted, SolvedOcp& solved) {
  auto& [stated, record, has_more, seconds, distance] = solved;
  const Stopwatch clock;
  const auto start = stepped_start(ocp, options, wanted, stated.problem->start_fractions(), record);
  if (!start) return std::nullopt;
  linalg::Vector w = stated.problem->add_start("the motion of time stepping", start->guess);
  solver::SolveOptions rest = wanted;
  rest.time_limit = solver::time_left(wanted, clock.seconds());
  auto found = solve_motion_of(ocp, rest, std::move(w), stated, record);
  if (!found) return std::nullopt;
  const double most = start->objective + error_of_steps * std::abs(start->objective);
  // Steps can leave a hysteresis between 0 and 1, which no motion does: they promise too much.
  found->is_as_good = found->solution.objective <= most && !ocp.physical->contacts.empty();
  return found;
}

/// Where steps promise more than their motion has come to, or lead nowhere, relaxed problems are solved, too.
std::optional<Error> solve_either_way(const model::Ocp& ocp, const OptimizeOptions& options,
                                      const solver::SolveOptions& wanted, SolvedOcp& solved) {
  const Stopwatch clock;
  auto from_steps = begins_freely(options) ? solve_from_steps(ocp, options, wanted, solved) : std::nullopt;
  if (!from_steps || !from_steps->is_as_good) {
    solver::SolveOptions rest = wanted;
    rest.time_limit = solver::time_left(wanted, clock.seconds());
    adapters::IpoptSolver ipopt(adapters::linear_solver_of(wanted.strategy));
    adapters::HighsLpcc highs;
    auto& problem = *solved.stated.problem;
    auto solution = solver::solve(problem, ipopt, highs, rest, same_structure(problem, options));
    if (!solution) return solution.error();
    solved.solution.starts = std::move(solution->starts);  // those of the path so far stay
    go_on_with(std::move(*solution), solved.solution);
  }
  const auto& other = solved.solution;
  const bool is_only = !from_steps || from_steps->is_as_good || other.termination != Termination::completed;
  if (!from_steps || !(is_only || from_steps->solution.objective < other.objective)) return std::nullopt;
  go_on_with(std::move(from_steps->solution), solved.solution);
  solved.has_more_elements = from_steps->elements != solved.stated.elements;
  solved.stated.elements = std::move(from_steps->elements);
  solved.stated.problem = std::move(from_steps->problem);
  return std::nullopt;
}

solver::SolveOptions one_start(const OptimizeOptions& options, const OptimizeObservers& observers) {
  solver::SolveOptions wanted = options.mpcc;
  wanted.starts = wanted.starts.value_or(1);
  wanted.is_interrupted = observers.is_interrupted;
  wanted.on_step = observers.on_step;
  return wanted;
}

}  // namespace

Expected<SolvedOcp> solve_ocp(const model::Ocp& ocp, const OptimizeOptions& options,
                              const OptimizeObservers& observers) {
  const Stopwatch building;
  auto stated = state_problem(ocp, options);
  if (!stated) return tl::unexpected(stated.error());
  for (const auto& warning : stated->warnings) observers.on_warning(warning);
  SolvedOcp solved{.stated = std::move(*stated), .solution = {}, .build_seconds = building.seconds()};
  solver::SolveOptions wanted = one_start(options, observers);
  wanted.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  wanted.make_workplace = [&] { return another_place(ocp, options); };
  const Stopwatch solving;
  if (auto error = solve_either_way(ocp, options, wanted, solved)) return tl::unexpected(std::move(*error));
  if (wanted.time_limit) *wanted.time_limit -= solving.seconds();
  MoreElements more(ocp, wanted, solved);
  for (int round = 0; round < most_rounds && more.add();) ++round;
  const auto& found = solved.solution;
  // Some sides of the same point need an element more.
  auto& tried = solved.solution.certificate.other_sides_tried;
  if (!solved.stated.problem->crowded_intervals(found.w, found.multipliers.upper, wanted.tolerance).empty() && tried) {
    tried = false;
  }
  return solved;
}

bool keep_off_touched(const OptimizeOptions& options, const OptimizeObservers& observers, int missed_in,
                      SolvedOcp& solved) {
  auto& [stated, solution, has_more, seconds, distance] = solved;
  if (!solution.crossed_over) return false;
  const double moved = stated.problem->keep_off_touched(solution.sides, solution.w, missed_in);
  distance = std::max(distance, moved);
  if (moved <= 0.0) return false;
  adapters::IpoptSolver ipopt(adapters::linear_solver_of(options.mpcc.strategy));
  adapters::HighsLpcc highs;
  const mpcc::NamedStart start{.name = "off what is touched", .w = solution.w, .sides = solution.sides};
  auto next = solver::solve_motion(*stated.problem, ipopt, highs, one_start(options, observers), start);
  if (next.termination != Termination::completed) return false;
  go_on_with(std::move(next), solution);
  return true;
}

}  // namespace saltus::pipeline
