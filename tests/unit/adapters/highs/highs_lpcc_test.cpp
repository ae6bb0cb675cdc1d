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

LpccProblem problem_of(const Eigen::MatrixXd& A, const Eigen::VectorXd& cost) {
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
  problem.entries = Eigen::Map<Eigen::VectorXd>(entries.data(), index(entries.size()));
  problem.rows = {Eigen::VectorXd::Zero(A.rows()), Eigen::VectorXd::Constant(A.rows(), infinity)};
  problem.variables = {-Eigen::VectorXd::Ones(A.cols()), Eigen::VectorXd::Ones(A.cols())};
  return problem;
}

TEST(HighsLpcc, ChoosesTheBetterSide) {
  // min -d0 - 2 d1 over 0 <= d0 _|_ d1 >= 0: d1 = 1.
  auto problem = problem_of(Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1.0, -2.0));
  problem.disjunctions = {{0, 1}};
  const LpccSolution solution = HighsLpcc().solve(problem, 10.0);
  EXPECT_EQ(solution.termination, Termination::completed);
  EXPECT_DOUBLE_EQ(solution.objective, -2.0);
  EXPECT_TRUE(solution.first_is_active[0]);
  EXPECT_EQ(solution.d, Eigen::Vector2d(0.0, 1.0));
}

TEST(HighsLpcc, OriginOfTheProblemWithoutStrongStationarity) {
  // scholtes4 of MacMPEC at its solution: min d0 + d1 - d2, 4 d0 >= d2, 4 d1 >= d2: every branch has d2 <= 0.
  Eigen::MatrixXd A(4, 3);
  A << 1, 0, 0, 0, 1, 0, 4, 0, -1, 0, 4, -1;
  auto problem = problem_of(A, Eigen::Vector3d(1.0, 1.0, -1.0));
  EXPECT_LT(HighsLpcc().solve(problem, 10.0).objective, -0.4);  // (1/4, 1/4, 1): without the disjunction it descends
  problem.disjunctions = {{0, 1}};
  const LpccSolution solution = HighsLpcc().solve(problem, 10.0);
  EXPECT_EQ(solution.termination, Termination::completed);
  EXPECT_EQ(solution.objective, 0.0);
}

TEST(HighsLpcc, SaysThatThereIsNoPoint) {
  Eigen::MatrixXd A(3, 2);
  A << 1, 0, 0, 1, 1, 1;
  auto problem = problem_of(A, Eigen::Vector2d(1.0, 1.0));
  problem.rows.lower[2] = 1.5;  // d0 + d1 >= 1.5 needs both
  problem.disjunctions = {{0, 1}};
  EXPECT_EQ(HighsLpcc().solve(problem, 10.0).termination, Termination::infeasible);
}

TEST(HighsLpcc, KeepsToItsLimits) {
  auto problem = problem_of(Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1.0, -2.0));
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
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * pairs + 2, n);
    A.topLeftCorner(2 * pairs, 2 * pairs).setIdentity();
    for (double& entry : A.bottomRows(2).reshaped()) entry = uniform(random);
    Eigen::VectorXd cost(n);
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
