#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/solver/certificate/linearise.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {
namespace {

using mpcc::ActiveSide;
using result::StationarityType;
using result::Termination;

constexpr double radius = 1e-3;
/// Barrier parameter of a branch that begins where its objective falls.
constexpr double near_mu = 1e-6;
/// Branches that a solution may visit: every one is better than the one before, so this is only a guard.
constexpr int largest_rounds = 200;
/// Of one branch problem: those that are solved need 25 to 130, and others stand still where equations depend on each
/// other.
constexpr int branch_iterations = 150;
/// Of one that begins at a point which is equal to the last: where it is better, that shows soon.
constexpr int move_iterations = 25;
/// Of the objective: a fall that is worth more iterations, or a point that is not solved yet.
constexpr double worth = 1e-3;
/// Of the objective, relative: what falls by less is not worth another point.
constexpr double worth_leaving = 1e-6;
/// Flips tried one by one before the linear program decides.
constexpr int flips_tried = 5;
/// Moves tried one by one of those that promise a fall.
constexpr int priced_tried = 8;

ActiveSide other(ActiveSide side) { return side == ActiveSide::G ? ActiveSide::H : ActiveSide::G; }

std::vector<ActiveSide> flipped(std::vector<ActiveSide> sides, const std::vector<int>& group) {
  for (const int pair : group) sides[at(pair)] = other(sides[at(pair)]);
  return sides;
}

/// Improvements below are rounding.
bool falls(double before, double after) { return after < before - 1e-11 * std::max(1.0, std::abs(before)); }

bool is_equal(double a, double b) { return !falls(a, b) && !falls(b, a); }

/// The branch that has been found, and what is known of it.
class Descent {
 public:
  explicit Descent(Run& run) : run_(run) {}

  /// @param is_solution  ends where a better branch is found, and gives false then
  bool descend(bool is_solution) {
    const double first = branch().objective;
    for (int round = 0; round < largest_rounds; ++round) {
      certify();
      if (run_.is_over() || !leaves()) break;
      if (is_solution && first - branch().objective > worth_leaving * std::max(1.0, std::abs(first))) return false;
    }
    const bool is_cut_short = run_.is_over();
    if (!is_certified()) go_back();
    run_.solution.certificate.other_sides_tried = !is_cut_short;
    return true;
  }

 private:
  /// A branch, and what was found of it.
  struct Certified {
    crossover::Branch branch;
    result::Certificate certificate;
  };

  /// Whether there is a better branch, which is taken.
  bool leaves() {
    if (run_.solution.certificate.b_stationary) return move();
    if (flip()) return true;
    if (run_.is_over()) return false;
    // Where the linear program leads to no better point another one may be beside it.
    return decide() || (!run_.is_over() && !run_.solution.certificate.b_stationary.value_or(false) && move());
  }

  [[nodiscard]] bool is_certified() const {
    const auto& of = run_.solution.certificate;
    return of.b_stationary.value_or(false) && of.stationarity <= tolerance();
  }

  /// What is not solved, and is hardly better, is not worth a certified point.
  void go_back() {
    if (!certified_) return;
    const double best = certified_->branch.objective;
    if (best - branch().objective > worth * std::max(1.0, std::abs(best))) return;
    run_.branch = std::move(certified_->branch);
    certify();
    run_.solution.certificate = certified_->certificate;
  }

  [[nodiscard]] crossover::Branch& branch() { return *run_.branch; }
  [[nodiscard]] double tolerance() const { return run_.options.tolerance; }

  void certify() {
    states_ = certificate::pair_states(run_.problem, branch().w, branch().sides, tolerance());
    auto& multipliers = run_.solution.multipliers;
    multipliers = certificate::multipliers_of_branch(run_.problem, *branch().problem, branch().point, states_);
    auto& of = run_.solution.certificate;
    of = {};
    of.primal_infeasibility = branch().primal_infeasibility;
    of.complementarity_residual = branch().complementarity_residual;
    of.stationarity = certificate::stationarity(run_.problem, branch().w, multipliers, &branch().problem->reduction());
    of.biactive = static_cast<int>(std::count(states_.biactive.begin(), states_.biactive.end(), true));
    of.stationarity_type = certificate::stationarity_type(multipliers, states_.biactive, tolerance());
    // Without a choice there is no other branch at this point. Where no choice has a negative multiplier, those of the
    // branch are multipliers of all others, too.
    const auto of_choices = certificate::stationarity_type(multipliers, states_.is_open, tolerance());
    if (of_choices == StationarityType::S && of.stationarity <= tolerance()) of.b_stationary = true;
  }

  /// Whether it is where it began, and may need more iterations to leave.
  [[nodiscard]] bool stays(const crossover::Branch& next) {
    return next.is_feasible(tolerance()) && is_equal(branch().objective, next.objective);
  }

  /// Whether it promises an objective that is worth more iterations.
  [[nodiscard]] bool is_nearly_better(const crossover::Branch& next) {
    constexpr double nearly_feasible = 1e-4;
    const double best = branch().objective;
    return next.is_feasible(nearly_feasible) && next.objective < best - worth * std::max(1.0, std::abs(best));
  }

  /// Takes the branch with the group on its other side if that is better.
  bool take(const mpcc::BranchMove& move, const std::string& message, int iterations = branch_iterations,
            std::optional<double> first_mu = std::nullopt) {
    const auto& sides = move.sides;
    const auto& appearing = move.appearing;
    if (!visited_.insert(sides).second) return false;
    crossover::Branch next =
        run_.solve_branch(sides, move.start, iterations, message, branch().objective, appearing, first_mu);
    const bool is_unfinished = next.report.termination == Termination::iteration_limit;
    if (is_unfinished && (stays(next) || is_nearly_better(next))) {
      next = run_.solve_branch(sides, next.w, branch_iterations, message, branch().objective, appearing);
    }
    // Where an element has length 0 its equations depend on each other, and what is stationary there may not be
    // optimal.
    if (!appearing.empty() && next.is_feasible(tolerance()) && falls(branch().objective, next.objective)) {
      next = run_.solve_branch(sides, next.w, branch_iterations, message, branch().objective);
    }
    // From another start it may get there.
    if (next.report.termination == Termination::iteration_limit) visited_.erase(sides);
    // Multipliers that are left say more.
    const bool is_as_good = move.is_simpler && is_equal(branch().objective, next.objective);
    if (!next.is_feasible(tolerance()) || !(is_as_good || falls(branch().objective, next.objective))) return false;
    if (is_certified()) {
      // A certified point is not given up for digits of its objective.
      const double least = std::max(worth_leaving * std::abs(branch().objective), tolerance());
      if (!move.is_simpler && branch().objective - next.objective < least) return false;
      certified_ = {std::move(branch()), run_.solution.certificate};
    }
    run_.branch = std::move(next);
    return true;
  }

  bool flip() {
    visited_.insert(branch().sides);
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t group = 0; group < run_.groups.size(); ++group) {
      if (!states_.is_open[at(run_.groups[group].front())]) continue;
      double lowest = 0.0;
      for (const int pair : run_.groups[group]) {
        const auto& of = run_.solution.multipliers;
        lowest = std::min(lowest, branch().sides[at(pair)] == ActiveSide::G ? of.G[pair] : of.H[pair]);
      }
      if (lowest < -10.0 * tolerance()) candidates.emplace_back(lowest, group);
    }
    std::sort(candidates.begin(), candidates.end());
    if (candidates.size() > flips_tried) candidates.resize(flips_tried);
    for (const auto& [multiplier, group] : candidates) {
      if (run_.is_over()) return false;
      if (take({flipped(branch().sides, run_.groups[group]), branch().w, {}}, "flip")) return true;
    }
    return false;
  }

  /// Branches beside this one: those whose multipliers promise a fall, all that are apart from each other at once, then
  /// the best of them one by one; then those of which the multipliers say nothing.
  bool move() {
    visited_.insert(branch().sides);
    auto candidates = run_.problem.neighbours(branch().sides, branch().w, run_.solution.multipliers);
    const double least = tolerance() * std::max(1.0, std::abs(branch().objective));
    std::erase_if(candidates, [&](const mpcc::BranchMove& move) { return move.price && !(*move.price < -least); });
    const auto unknown = std::stable_partition(candidates.begin(), candidates.end(),
                                               [](const mpcc::BranchMove& move) { return move.price.has_value(); });
    std::stable_sort(candidates.begin(), unknown, [](const auto& a, const auto& b) { return *a.price < *b.price; });
    const auto priced = unknown - candidates.begin();
    if (priced > 1 && take_move(together({candidates.begin(), unknown}))) return true;
    if (priced > priced_tried) candidates.erase(candidates.begin() + priced_tried, unknown);
    for (const auto& move : candidates) {
      if (run_.is_over()) return false;
      if (take_move(move)) return true;
    }
    return false;
  }

  bool take_move(const mpcc::BranchMove& move) {
    return take(move, "another mode sequence: " + move.name, move_iterations);
  }

  /// Moves in one, the best first: each that changes nothing that one before it changes.
  [[nodiscard]] mpcc::BranchMove together(const std::vector<mpcc::BranchMove>& moves) {
    mpcc::BranchMove all{.sides = branch().sides, .start = branch().w, .name = "several moves"};
    for (const auto& move : moves) {
      bool is_apart = true;
      for (std::size_t i = 0; i < all.sides.size(); ++i) {
        is_apart = is_apart && (move.sides[i] == branch().sides[i] || all.sides[i] == branch().sides[i]);
      }
      for (linalg::Index i = 0; i < all.start.size(); ++i) {
        is_apart = is_apart && (move.start[i] == branch().w[i] || all.start[i] == branch().w[i]);
      }
      if (!is_apart) continue;
      for (std::size_t i = 0; i < all.sides.size(); ++i) {
        if (move.sides[i] != branch().sides[i]) all.sides[i] = move.sides[i];
      }
      for (linalg::Index i = 0; i < all.start.size(); ++i) {
        if (move.start[i] != branch().w[i]) all.start[i] = move.start[i];
      }
      all.appearing.insert(all.appearing.end(), move.appearing.begin(), move.appearing.end());
    }
    return all;
  }

  /// The linear program: true if it led to a better branch, else the certificate has its answer.
  bool decide() {
    const double started = run_.seconds();
    const auto linear =
        certificate::linearise(run_.problem, branch().w, states_, &branch().problem->reduction(), radius);
    const LpccSolution found = run_.lpcc.solve(linear.problem, seconds_of_lpcc(run_));
    result::HomotopyStep step;
    step.phase = result::HomotopyPhase::lpcc;
    step.solver = run_.lpcc.name();
    step.sigma = run_.relaxed.sigma;
    step.iterations = found.nodes;
    step.objective = branch().objective;
    step.primal_infeasibility = branch().primal_infeasibility;
    step.complementarity_residual = branch().complementarity_residual;
    step.termination = found.termination;
    run_.record(step, nullptr, started);
    if (found.termination != Termination::completed) return false;
    auto& of = run_.solution.certificate;
    of.lpcc_decrease = std::min(found.objective, 0.0) / linear.scale;
    of.b_stationary = *of.lpcc_decrease >= -tolerance();
    if (*of.b_stationary) return move();
    std::vector<ActiveSide> sides = branch().sides;
    for (std::size_t i = 0; i < linear.groups.size(); ++i) {
      for (const int pair : linear.groups[i])
        sides[at(pair)] = found.first_is_active[i] ? ActiveSide::G : ActiveSide::H;
    }
    if (take({sides, branch().w, {}}, "proposed by the linear program")) return true;
    // Better points are beside this one: a barrier that leaves it there does not pass them by.
    return visited_.erase(sides) > 0 && take({sides, branch().w + radius * found.d, {}},
                                             "proposed by the linear program", branch_iterations, near_mu);
  }

  Run& run_;
  certificate::PairStates states_;
  std::set<std::vector<ActiveSide>> visited_;
  std::optional<Certified> certified_;  ///< the last one that was left
};

}  // namespace

void descend(Run& run) { Descent(run).descend(/*is_solution=*/false); }

bool remains(Run& run) { return Descent(run).descend(/*is_solution=*/true); }

void rescue(Run& run) {
  const linalg::Vector w = run.relaxed.point.w.head(run.problem.variables());
  linalg::Vector c(run.problem.rows());
  run.problem.functions(w, c);
  const auto sides = crossover::smaller_sides(run.problem, run.groups, c);
  // Undecided is what the last sigma has not pulled to an axis: products are below it, sides below its root.
  const double undecided = 0.3 * std::sqrt(std::max(run.relaxed.sigma, 1e-12));
  const auto states = certificate::pair_states(run.problem, w, sides, undecided);
  const auto linear = certificate::linearise(run.problem, w, states, nullptr, std::max(radius, 10.0 * undecided));
  if (!run.is_over() && !linear.groups.empty()) {
    const LpccSolution found = run.lpcc.solve(linear.problem, seconds_of_lpcc(run));
    std::vector<ActiveSide> proposed = sides;
    if (found.termination == Termination::completed) {
      for (std::size_t i = 0; i < linear.groups.size(); ++i) {
        for (const int pair : linear.groups[i]) {
          proposed[at(pair)] = found.first_is_active[i] ? ActiveSide::G : ActiveSide::H;
        }
      }
      crossover::Branch branch = run.solve_branch(proposed, w, branch_iterations, "proposed by the linear program");
      const bool is_better = !run.refused || falls(run.refused->objective, branch.objective);
      if (branch.is_feasible(run.options.tolerance) && is_better) run.refused = std::move(branch);
    }
  }
  run.branch = std::move(run.refused);
}

void certify_relaxed(Run& run) {
  const int n = run.problem.variables();
  const linalg::Vector w = run.relaxed.point.w.head(n);
  linalg::Vector c(run.problem.rows());
  run.problem.functions(w, c);
  const auto sides = crossover::smaller_sides(run.problem, run.groups, c);
  const auto states = certificate::pair_states(run.problem, w, sides, run.options.tolerance);
  auto& of = run.solution.certificate;
  of = {};
  of.primal_infeasibility = certificate::scaled_infeasibility(run.problem, w);
  of.complementarity_residual = certificate::complementarity(run.problem, w);
  of.stationarity = std::numeric_limits<double>::quiet_NaN();
  of.biactive = static_cast<int>(std::count(states.biactive.begin(), states.biactive.end(), true));
  if (run.relaxed.point.y.size() != run.relaxed.problem->constraints()) return;
  const bool is_feasible =
      of.primal_infeasibility <= run.options.tolerance && of.complementarity_residual <= run.options.tolerance;
  auto& multipliers = run.solution.multipliers;
  multipliers = certificate::multipliers_of_relaxed(run.problem, *run.relaxed.problem, run.relaxed.point, states);
  of.stationarity = certificate::stationarity(run.problem, w, multipliers, nullptr);
  // Directions from a point that is not feasible, and multipliers there, say nothing of the problem.
  if (!is_feasible) return;
  of.stationarity_type = certificate::stationarity_type(multipliers, states.biactive, run.options.tolerance);
  if (of.stationarity_type == StationarityType::S) {
    if (of.stationarity <= run.options.tolerance) of.b_stationary = true;
    return;
  }
  if (run.stopped) return;
  const auto linear = certificate::linearise(run.problem, w, states, nullptr, radius);
  const LpccSolution found = run.lpcc.solve(linear.problem, seconds_of_lpcc(run));
  if (found.termination != Termination::completed) return;
  of.lpcc_decrease = std::min(found.objective, 0.0) / linear.scale;
  of.b_stationary = *of.lpcc_decrease >= -run.options.tolerance;
}

}  // namespace saltus::solver
