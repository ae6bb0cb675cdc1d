// One optimum whichever linear solver Ipopt has.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/solve.hpp"
#include "source_folder.hpp"

namespace saltus::ocp_tests {
namespace {

using adapters::LinearSolver;

solver::Solution solved_with(LinearSolver linear_solver, const Stated& problem) {
  auto stated_problem = pipeline::state_problem(problem.ocp, problem.options);
  EXPECT_TRUE(stated_problem) << (stated_problem ? "" : to_text(stated_problem.error()));
  adapters::IpoptSolver ipopt(linear_solver);
  adapters::HighsLpcc highs;
  auto solution = solver::solve(*stated_problem->problem, ipopt, highs, problem.options.mpcc);
  EXPECT_TRUE(solution) << (solution ? "" : to_text(solution.error()));
  return std::move(*solution);
}

Stated of_catalogue(const std::string& model) {
  std::ifstream file(tests::source_folder("models") / (model + ".toml"));
  std::ostringstream text;
  text << file.rdbuf();
  return stated(text.str());
}

void expect_one_optimum(const Stated& problem) {
  const auto mumps = solved_with(LinearSolver::mumps, problem);
  const auto blocks = solved_with(LinearSolver::block_ldl, problem);
  EXPECT_EQ(mumps.termination, result::Termination::completed) << mumps.message;
  EXPECT_EQ(blocks.termination, result::Termination::completed) << blocks.message;
  EXPECT_NEAR(blocks.objective, mumps.objective, 1e-8 * std::max(1.0, std::abs(mumps.objective)));
}

TEST(OcpLinearSolver, FindsTheOptimumOfATurboCar) { expect_one_optimum(stated(turbo_car(20, 10))); }

TEST(OcpLinearSolver, FindsTheOptimumOfAStartThatIsFree) {
  expect_one_optimum(stated(stewart_anitescu("elements = 25\n")));
}

TEST(OcpLinearSolver, FindsTheOptimumAlongASlidingMode) { expect_one_optimum(of_catalogue("slide-and-hide")); }

/// The cart-pole has so many optima that rounding decides between them.
TEST(OcpLinearSolver, FindsTheOptimumOfAMotor) { expect_one_optimum(of_catalogue("voice-coil")); }

}  // namespace
}  // namespace saltus::ocp_tests
