#include "saltus/adapters/highs/highs_lpcc.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "saltus/base/at.hpp"

namespace saltus::adapters {
namespace {

using result::Termination;
using solver::LpccProblem;
using solver::LpccSolution;

constexpr double infinity = std::numeric_limits<double>::infinity();

LpccProblem problem_of(const linalg::Matrix& A, const linalg::Vector& cost) {
  LpccProblem problem;
  problem.cost = cost;
  std::vector<double> entries;
  for (int i = 0; i < A.rows(); ++i) {
    for (int j = 0; j < A.cols(); ++j) {
      if (A(i, j) == 0.0) continue;
      problem.pattern.add(i, j);
      entries.push_back(A(i, j));
    }
  }
  problem.entries = linalg::ConstView(entries);
  problem.rows = {linalg::Vector::zero(A.rows()), linalg::Vector::constant(A.rows(), infinity)};
  problem.variables = {-linalg::Vector::ones(A.cols()), linalg::Vector::ones(A.cols())};
  return problem;
}

TEST(HighsLpcc, ChoosesTheBetterSide) {
  // min -d0 - 2 d1 over 0 <= d0 _|_ d1 >= 0: d1 = 1.
  auto problem = problem_of(linalg::Matrix::identity(2, 2), linalg::Vector{-1.0, -2.0});
  problem.disjunctions = {{0, 1}};
  const LpccSolution solution = HighsLpcc().solve(problem, 10.0);
  EXPECT_EQ(solution.termination, Termination::completed);
  EXPECT_DOUBLE_EQ(solution.objective, -2.0);
  EXPECT_TRUE(solution.first_is_active[0]);
  EXPECT_EQ(solution.d, (linalg::Vector{0.0, 1.0}));
}

TEST(HighsLpcc, OriginOfTheProblemWithoutStrongStationarity) {
  // scholtes4 of MacMPEC at its solution: min d0 + d1 - d2, 4 d0 >= d2, 4 d1 >= d2: every branch has d2 <= 0.
  const linalg::Matrix A{{1, 0, 0}, {0, 1, 0}, {4, 0, -1}, {0, 4, -1}};
  auto problem = problem_of(A, linalg::Vector{1.0, 1.0, -1.0});
  EXPECT_LT(HighsLpcc().solve(problem, 10.0).objective, -0.4);  // (1/4, 1/4, 1): without the disjunction it descends
  problem.disjunctions = {{0, 1}};
  const LpccSolution solution = HighsLpcc().solve(problem, 10.0);
  EXPECT_EQ(solution.termination, Termination::completed);
  EXPECT_EQ(solution.objective, 0.0);
}

TEST(HighsLpcc, SaysThatThereIsNoPoint) {
  const linalg::Matrix A{{1, 0}, {0, 1}, {1, 1}};
  auto problem = problem_of(A, linalg::Vector{1.0, 1.0});
  problem.rows.lower[2] = 1.5;  // d0 + d1 >= 1.5 needs both
  problem.disjunctions = {{0, 1}};
  EXPECT_EQ(HighsLpcc().solve(problem, 10.0).termination, Termination::infeasible);
}

TEST(HighsLpcc, KeepsToItsLimits) {
  auto problem = problem_of(linalg::Matrix::identity(2, 2), linalg::Vector{-1.0, -2.0});
  problem.disjunctions = {{0, 1}};
  EXPECT_EQ(HighsLpcc().solve(problem, 0.0).termination, Termination::time_limit);
  EXPECT_EQ(HighsLpcc(1).solve(problem, 10.0).termination, Termination::not_converged);
}

TEST(HighsLpcc, AgreesWithEnumerationOfAllSides) {
  std::mt19937 random(4711);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int instance = 0; instance < 30; ++instance) {
    const int pairs = 1 + instance % 5;
    const int n = 2 * pairs + 2;
    linalg::Matrix A = linalg::Matrix::zero(2 * pairs + 2, n);
    A.block(0, 0, 2 * pairs, 2 * pairs).set_identity();
    for (int j = 0; j < n; ++j) {
      for (int i = 2 * pairs; i < A.rows(); ++i) A(i, j) = uniform(random);
    }
    linalg::Vector cost(n);
    for (double& entry : cost) entry = uniform(random);
    auto problem = problem_of(A, cost);
    for (int pair = 0; pair < pairs; ++pair) problem.disjunctions.emplace_back(2 * pair, 2 * pair + 1);
    double best = infinity;
    for (int mask = 0; mask < (1 << pairs); ++mask) {
      auto branch = problem;
      branch.disjunctions.clear();
      for (int pair = 0; pair < pairs; ++pair) branch.rows.upper[2 * pair + ((mask >> pair) & 1)] = 0.0;
      best = std::min(best, HighsLpcc().solve(branch, 10.0).objective);
    }
    const LpccSolution solution = HighsLpcc().solve(problem, 10.0);
    EXPECT_EQ(solution.termination, Termination::completed);
    EXPECT_NEAR(solution.objective, best, 1e-9) << instance;
    for (const auto& [first, second] : problem.disjunctions) {
      EXPECT_LE(std::min(solution.d[first], solution.d[second]), 1e-9);
    }
  }
}

}  // namespace
}  // namespace saltus::adapters
