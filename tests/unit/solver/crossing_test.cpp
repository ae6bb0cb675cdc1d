#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/crossing_internal.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

/// min (w0 - 1)^2 + (w1 - 1)^2, 0 <= w0 _|_ w1 >= 0: f = 1 on both branches.
mpcc::PolynomialProblem two_sides() {
  return mpcc::PolynomialProblem(small::statement(2, 1, small::distance(1.0, 1.0)));
}

/// Two paths that come to the same sides solve one branch problem.
TEST(Crossing, KnowsTheBranchesOfOtherPaths) {
  auto problem = two_sides();
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  const SolveOptions options;
  solver::Run run(problem, ipopt, highs, options);
  // Below the branch in objective, as relaxed points are.
  const linalg::Vector near{0.9, 0.5}, far{0.8, 0.6};
  Crossing first(run), second(run);
  EXPECT_FALSE(first.cross({.w = near, .sigma = 1e-4}));
  ASSERT_TRUE(run.refused.has_value());
  EXPECT_NEAR(run.refused->objective, 1.0, 1e-9);
  const auto solved = run.solution.homotopy.size();
  EXPECT_EQ(solved, 1u);
  EXPECT_FALSE(second.cross({.w = far, .sigma = 1e-4}));
  EXPECT_FALSE(second.cross({.w = near, .sigma = 1e-5}));
  EXPECT_EQ(run.solution.homotopy.size(), solved);
  EXPECT_EQ(second.same_refused(), 2);
  EXPECT_NEAR(second.refused_objective(), 1.0, 1e-9);
  // A relaxed point that is as good as the branch accepts it.
  const linalg::Vector on_it{1.0, 0.0};
  EXPECT_TRUE(second.cross({.w = on_it, .sigma = 1e-6}));
  EXPECT_EQ(run.solution.homotopy.size(), solved);
  ASSERT_TRUE(run.branch.has_value());
  EXPECT_NEAR(run.branch->objective, 1.0, 1e-9);
}

}  // namespace
}  // namespace saltus::solver
