// Prices of mode sequences beside a solved branch, against differences of optima.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/discretization/ocp/insertion_prices_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/certificate/multipliers.hpp"
#include "saltus/solver/crossover/branch.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "stated_problem.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ConstVectorView;
using mpcc::VectorView;

/// A problem one of whose variables has a value.
class Pinned final : public mpcc::Problem {
 public:
  Pinned(OcpProblem& problem, int variable, double value) : problem_(problem), bounds_(problem.variable_bounds()) {
    bounds_.lower[variable] = bounds_.upper[variable] = value;
  }
  int variables() const override { return problem_.variables(); }
  int constraints() const override { return problem_.constraints(); }
  int pairs() const override { return problem_.pairs(); }
  const mpcc::Bounds& variable_bounds() const override { return bounds_; }
  const mpcc::Bounds& constraint_bounds() const override { return problem_.constraint_bounds(); }
  const std::vector<mpcc::Sign>& signs() const override { return problem_.signs(); }
  double objective(ConstVectorView w) override { return problem_.objective(w); }
  void objective_gradient(ConstVectorView w, VectorView gradient) override { problem_.objective_gradient(w, gradient); }
  void functions(ConstVectorView w, VectorView c) override { problem_.functions(w, c); }
  void jacobian(ConstVectorView w, VectorView values) override { problem_.jacobian(w, values); }
  void hessian(ConstVectorView w, double factor, ConstVectorView y, VectorView values) override {
    problem_.hessian(w, factor, y, values);
  }
  const mpcc::Pattern& jacobian_pattern() const override { return problem_.jacobian_pattern(); }
  const mpcc::Pattern& hessian_pattern() const override { return problem_.hessian_pattern(); }
  int pair_group(int pair) const override { return problem_.pair_group(pair); }
  mpcc::BranchClosure close_branch(const std::vector<mpcc::ActiveSide>& sides) const override {
    return problem_.close_branch(sides);
  }

 private:
  OcpProblem& problem_;
  mpcc::Bounds bounds_;
};

/// A block with dry friction is moved with least effort; its start is what the simulation of its first guess gives.
std::string block(const std::string& more) {
  return R"toml(
[model]
name = "block"
[states]
q = 0
v = 0
[controls]
u = { lower = -8, upper = 8, initial = 2 }
[dynamics]
q = "v"
v = "u - sign(v)"
[optimize]
start = "simulated"
control_intervals = 4
elements = 3
)toml" + more;
}

/// The branch of the sides of a start, and the moves beside its solution.
struct Solved {
  pipeline::StatedProblem stated;
  std::unique_ptr<adapters::IpoptSolver> ipopt;
  solver::crossover::Branch branch;
  std::vector<mpcc::BranchMove> moves;
};

Solved solved_at_start(const std::string& text) {
  Solved solved{
      stated_problem(text), std::make_unique<adapters::IpoptSolver>(adapters::LinearSolver::block_ldl), {}, {}};
  auto& problem = *solved.stated.problem;
  linalg::Vector c(problem.rows());
  problem.functions(problem.start(), c);
  const auto sides = solver::crossover::smaller_sides(problem, solver::crossover::groups_of(problem), c);
  solver::NlpOptions options;
  options.tolerance = 1e-10;
  solved.branch = solver::crossover::solve_branch(problem, sides, problem.start(), *solved.ipopt, options);
  EXPECT_LE(solved.branch.primal_infeasibility, 1e-9);
  const auto states = solver::certificate::pair_states(problem, solved.branch.w, sides, 1e-8);
  const auto multipliers =
      solver::certificate::multipliers_of_branch(problem, *solved.branch.problem, solved.branch.point, states);
  solved.moves = problem.neighbours(sides, solved.branch.w, multipliers);
  return solved;
}

/// The objective with the inserted element of a move at the length of its start.
std::optional<double> objective_of(Solved& solved, const mpcc::BranchMove& move) {
  Pinned pinned(*solved.stated.problem, move.appearing.front(), move.start[move.appearing.front()]);
  solver::NlpOptions options;
  options.tolerance = 1e-10;
  const auto branch = solver::crossover::solve_branch(pinned, move.sides, move.start, *solved.ipopt, options);
  if (branch.primal_infeasibility > 1e-8) return std::nullopt;
  return branch.objective;
}

/// Moves that insert one element, the best first.
std::vector<mpcc::BranchMove> insertions(const Solved& solved) {
  std::vector<mpcc::BranchMove> list;
  for (const auto& move : solved.moves) {
    if (move.price && std::isfinite(*move.price) && *move.price < -1e-6 && move.appearing.size() == 1) {
      list.push_back(move);
    }
  }
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return *a.price < *b.price; });
  return list;
}

/// Prices of modes that the motion cannot go on in belong to branches without a solution.
void expect_prices(const std::string& text) {
  auto solved = solved_at_start(text);
  int compared = 0;
  for (const auto& move : insertions(solved)) {
    const auto objective = objective_of(solved, move);
    if (!objective) continue;
    EXPECT_NEAR(*objective - solved.branch.objective, *move.price, 0.02 * std::abs(*move.price));
    ++compared;
  }
  EXPECT_GE(compared, 1);
}

TEST(Neighbours, PriceARestAtTheEndByWhatItChanges) {
  expect_prices(block("horizon = 4\nrunning_cost = \"u^2\"\nterminal_constraints = [\"q == 0.2\"]\n"));
}

}  // namespace
}  // namespace saltus::discretization
