// Ipopt with linalg::BlockLdl goes the way that it goes with MUMPS.
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "../../mpcc/polynomial_problem.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"

namespace saltus::solver {
namespace {

using adapters::IpoptSolver;
using adapters::LinearSolver;
using mpcc::Monomial;
using mpcc::PolynomialProblem;
using mpcc::PolynomialStatement;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr int steps = 8;

/// x_{k+1} = x_k + u_k / 8 - x_k^3 / 8 from 1 to 0 with the least sum of u_k^2 + x_k^2, u_k >= -0.9, and x_k u_k <=
/// 0.1. Variables x_0 (fixed), u_0, x_1, u_1, ..., x_8.
PolynomialStatement drive_to_rest() {
  constexpr double h = 1.0 / steps;
  PolynomialStatement statement;
  statement.variables = 2 * steps + 1;
  statement.w_bounds = {linalg::Vector::constant(statement.variables, -unbounded),
                        linalg::Vector::constant(statement.variables, unbounded)};
  statement.w_bounds.lower[0] = statement.w_bounds.upper[0] = 1.0;
  const auto power = [&](int variable, int of) {
    std::vector<int> powers(static_cast<std::size_t>(variable) + 1, 0);
    powers.back() = of;
    return powers;
  };
  for (int k = 0; k < steps; ++k) {
    const int x = 2 * k, u = x + 1, next = x + 2;
    statement.w_bounds.lower[u] = -0.9;
    statement.f.terms.push_back({1.0, power(u, 2)});
    statement.f.terms.push_back({1.0, power(next, 2)});
    statement.g.push_back({{{1.0, power(next, 1)}, {-1.0, power(x, 1)}, {-h, power(u, 1)}, {h, power(x, 3)}}});
    auto product = power(u, 1);
    product[static_cast<std::size_t>(x)] = 1;
    statement.g.push_back({{{1.0, product}}});
  }
  statement.g.push_back({{{1.0, power(2 * steps, 1)}}});
  const int rows = 2 * steps + 1;
  statement.g_bounds = {linalg::Vector::zero(rows), linalg::Vector::zero(rows)};
  for (int k = 0; k < steps; ++k) {
    statement.g_bounds.lower[2 * k + 1] = -unbounded;
    statement.g_bounds.upper[2 * k + 1] = 0.1;
  }
  return statement;
}

struct Run {
  NlpReport report;
  NlpPoint point;
};

Run run(const PolynomialStatement& statement, IpoptSolver& solver) {
  PolynomialProblem problem(statement);
  Run result;
  result.point.w = linalg::Vector::constant(statement.variables, 0.5);
  result.report = solver.solve(problem, result.point, {});
  return result;
}

void expect_same(const Run& one, const Run& other) {
  EXPECT_EQ(one.report.termination, result::Termination::completed) << one.report.message;
  EXPECT_EQ(other.report.termination, result::Termination::completed) << other.report.message;
  EXPECT_EQ(one.report.iterations, other.report.iterations);
  EXPECT_NEAR(one.report.objective, other.report.objective, 1e-9);
  EXPECT_LE((one.point.w - other.point.w).max_abs(), 1e-7);
  EXPECT_LE((one.point.y - other.point.y).max_abs(), 1e-6);
}

TEST(BlockSolver, takes_the_steps_of_mumps_in_an_order_that_is_given_and_in_one_that_is_found) {
  IpoptSolver mumps, blocks(LinearSolver::block_ldl);
  auto statement = drive_to_rest();
  const auto expected = run(statement, mumps);
  expect_same(run(statement, blocks), expected);
  for (int k = 0; k < statement.variables; ++k) statement.elimination_blocks.push_back(steps - k / 2);
  expect_same(run(statement, blocks), expected);
}

TEST(BlockSolver, is_used_again_for_problems_of_other_sizes) {
  IpoptSolver mumps, blocks(LinearSolver::block_ldl);
  auto statement = drive_to_rest();
  expect_same(run(statement, blocks), run(statement, mumps));
  // A free start, and a terminal value for x_7 as well, stated twice: Ipopt has to regularise the equations.
  statement.w_bounds.lower[0] = 0.9;
  statement.g.push_back(statement.g.back());
  statement.g_bounds.lower = statement.g_bounds.upper = linalg::Vector::zero(2 * steps + 2);
  for (int k = 0; k < steps; ++k) statement.g_bounds.lower[2 * k + 1] = -unbounded;
  const auto again = run(statement, blocks);
  EXPECT_EQ(again.report.termination, result::Termination::completed) << again.report.message;
  EXPECT_NEAR(again.report.objective, run(statement, mumps).report.objective, 1e-8);
}

TEST(BlockSolver, solves_where_all_variables_are_fixed_or_as_many_as_equations) {
  // Without free variables Ipopt relaxes the bounds of fixed ones: another system than the order is for.
  PolynomialStatement statement;
  statement.variables = 2;
  statement.f = {{{1.0, {2}}, {1.0, {0, 2}}}};
  statement.g = {{{{1.0, {1}}, {1.0, {0, 1}}}}};
  statement.g_bounds = {linalg::Vector::constant(1, 3.0), linalg::Vector::constant(1, 3.0)};
  statement.w_bounds = {linalg::Vector{1.0, -unbounded}, linalg::Vector{1.0, unbounded}};
  statement.elimination_blocks = {0, 0};
  IpoptSolver blocks(LinearSolver::block_ldl);
  const auto result = run(statement, blocks);
  EXPECT_EQ(result.report.termination, result::Termination::completed) << result.report.message;
  EXPECT_NEAR(result.point.w[1], 2.0, 1e-9);
}

}  // namespace
}  // namespace saltus::solver
