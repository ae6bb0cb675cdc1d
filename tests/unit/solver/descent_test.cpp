// From a branch to better ones: flips, the linear program, groups of pairs, closures.
#include <gtest/gtest.h>

#include "../mpcc/counting_problem.hpp"
#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/run_internal.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

using enum mpcc::ActiveSide;
using result::HomotopyPhase;
using result::StationarityType;

/// Solves the branch of the sides, then descends from it.
Solution descended(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides, const linalg::Vector& from) {
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  const SolveOptions options;
  Run run(problem, ipopt, highs, options);
  run.branch = run.solve_branch(sides, from, 500);
  descend(run);
  run.solution.w = run.branch->w;
  run.solution.sides = run.branch->sides;
  run.solution.objective = run.branch->objective;
  return run.solution;
}

int count(const Solution& solution, HomotopyPhase phase) {
  return static_cast<int>(std::count_if(solution.homotopy.begin(), solution.homotopy.end(),
                                        [&](const auto& step) { return step.phase == phase; }));
}

/// min w0^2 - w0 + w1: in the branch w0 = 0 the origin, nu = (-1, 1); in the other one (1/2, 0).
mpcc::PolynomialStatement needs_a_flip() { return small::statement(2, 1, {{{1.0, {2}}, {-1.0, {1}}, {1.0, {0, 1}}}}); }

TEST(Descent, FlipsWhatAMultiplierPointsAt) {
  for (const bool implied : {false, true}) {
    auto statement = needs_a_flip();
    if (implied) small::imply_signs(statement);
    mpcc::PolynomialProblem problem(statement);
    if (implied) small::imply_signs(problem);
    const Solution solution = descended(problem, {G}, linalg::Vector{0.0, 1.0});
    EXPECT_NEAR(solution.w[0], 0.5, 1e-12);
    EXPECT_NEAR(solution.objective, -0.25, 1e-12);
    EXPECT_EQ(solution.sides, std::vector{H});
    EXPECT_EQ(solution.certificate.stationarity_type, StationarityType::S);
    EXPECT_EQ(solution.certificate.b_stationary, true);
    EXPECT_EQ(count(solution, HomotopyPhase::branch), 2);
    EXPECT_EQ(count(solution, HomotopyPhase::lpcc), 0);
  }
}

TEST(Descent, LinearProgramFindsWhatNoSingleFlipDoes) {
  // Two of those with w0 = w2: only both flips together move anything.
  auto statement = small::statement(
      4, 2, {{{1.0, {2}}, {-1.0, {1}}, {1.0, {0, 1}}, {1.0, {0, 0, 2}}, {-1.0, {0, 0, 1}}, {1.0, {0, 0, 0, 1}}}});
  small::add_row(statement, {{{1.0, {1}}, {-1.0, {0, 0, 1}}}}, 0.0, 0.0);
  mpcc::PolynomialProblem problem(statement);
  const Solution solution = descended(problem, {G, G}, linalg::Vector{0.0, 1.0, 0.0, 1.0});
  EXPECT_NEAR(solution.objective, -0.5, 1e-12);
  EXPECT_EQ(solution.sides, (std::vector{H, H}));
  EXPECT_GE(count(solution, HomotopyPhase::lpcc), 1);
  EXPECT_EQ(solution.certificate.b_stationary, true);
}

TEST(Descent, FindsTheValleyBesideThePoint) {
  // min p(500 w0) + 10 w1 with p' = (s - 0.2) (s - 3) (s - 3.5): the origin, where p falls to -0.2015 at s = 0.2. What
  // begins a hundredth away comes to s = 3.5, where p = 6.7.
  mpcc::PolynomialProblem problem(small::statement(
      2, 1, {{{1.5625e10, {4}}, {-6.7 / 3.0 * 1.25e8, {3}}, {1.475e6, {2}}, {-1050.0, {1}}, {10.0, {0, 1}}}}));
  const Solution solution = descended(problem, {G}, linalg::Vector{0.0, 1.0});
  EXPECT_NEAR(solution.w[0], 0.2 / 500.0, 1e-9);
  EXPECT_NEAR(solution.objective, -0.201466666666667, 1e-9);
  EXPECT_EQ(solution.certificate.b_stationary, true);
}

TEST(Descent, BStationaryWithoutBeingStrongly) {
  mpcc::PolynomialProblem problem(small::b_not_strong());
  const Solution solution = descended(problem, {G}, linalg::Vector{0.0, 1.0, 0.0});
  EXPECT_NEAR(solution.w.norm(), 0.0, 1e-12);
  EXPECT_NE(solution.certificate.stationarity_type, StationarityType::S);
  EXPECT_EQ(solution.certificate.b_stationary, true);
  EXPECT_NEAR(solution.certificate.lpcc_decrease.value(), 0.0, 1e-9);
}

/// An element with two points: 0 <= theta = (w0, w1) _|_ lambda = (w2, w3) >= 0 crosswise, lengths w4 + w5 = 1.
mpcc::PolynomialStatement element() {
  auto statement = small::statement(6, 0,
                                    {{{1.0, {2}},
                                      {-2.0, {1}},
                                      {1.0, {0, 2}},
                                      {-4.0, {0, 1}},
                                      {1.0, {0, 0, 2}},
                                      {-2.0, {0, 0, 1}},
                                      {1.0, {0, 0, 0, 1}},
                                      {1.0, {0, 0, 0, 0, 2}},
                                      {-0.6, {0, 0, 0, 0, 1}}}});
  for (const int theta : {0, 1}) {
    for (const int lambda : {2, 3}) {
      statement.G.push_back(small::variable(theta));
      statement.H.push_back(small::variable(lambda));
    }
  }
  statement.w_bounds.lower.set_zero();
  small::add_row(statement, {{{1.0, {0, 0, 0, 0, 1}}, {1.0, {0, 0, 0, 0, 0, 1}}}}, 1.0, 1.0);
  return statement;
}

TEST(Descent, GroupsFlipTogetherAndClosuresHold) {
  mpcc::PolynomialProblem inner(element());
  small::imply_signs(inner);
  mpcc::CountingProblem problem(inner);
  problem.set_groups({7, 7, 7, 7});
  for (const bool closes : {false, true}) {
    problem.set_closure([closes](const auto&) {
      mpcc::BranchClosure closure;
      if (closes) closure.equal.emplace_back(4, 5);
      return closure;
    });
    const Solution solution = descended(problem, {H, H, H, H}, linalg::Vector::constant(6, 0.5));
    // theta = (1, 2), lambda = 0: -5; and of the lengths (w4 - 0.3)^2 - 0.09.
    EXPECT_NEAR(solution.w[0], 1.0, 1e-12);
    EXPECT_NEAR(solution.w[1], 2.0, 1e-12);
    EXPECT_NEAR(solution.w[4], closes ? 0.5 : 0.3, 1e-12);
    EXPECT_NEAR(solution.objective, closes ? -5.05 : -5.09, 1e-12);
    EXPECT_LE(solution.certificate.stationarity, 1e-12);
    EXPECT_EQ(solution.certificate.stationarity_type, StationarityType::S);
  }
}

TEST(Descent, WhatAClosureHoldsIsNoChoice) {
  auto statement = needs_a_flip();
  small::imply_signs(statement);
  mpcc::PolynomialProblem inner(statement);
  small::imply_signs(inner);
  mpcc::CountingProblem problem(inner);
  problem.set_closure([](const auto&) {
    mpcc::BranchClosure closure;
    closure.at_lower = {0};
    return closure;
  });
  const Solution solution = descended(problem, {G}, linalg::Vector{0.0, 1.0});
  EXPECT_NEAR(solution.w.norm(), 0.0, 1e-9);
  EXPECT_EQ(count(solution, HomotopyPhase::branch), 1);
  EXPECT_EQ(count(solution, HomotopyPhase::lpcc), 0);
  EXPECT_EQ(solution.certificate.b_stationary, true);
}

MpccMultipliers of_pairs(const linalg::Vector& nu_G, const linalg::Vector& nu_H) {
  return {.rows = {}, .lower = {}, .upper = {}, .G = nu_G, .H = nu_H};
}

TEST(StationarityType, ByTheSignsOnBiactivePairs) {
  const auto type = [](double G0, double H0, double G1, double H1) {
    return certificate::stationarity_type(of_pairs(linalg::Vector{G0, G1}, linalg::Vector{H0, H1}), {true, true}, 1e-8);
  };
  EXPECT_EQ(type(1.0, 2.0, 0.0, 3.0), StationarityType::S);
  EXPECT_EQ(type(1.0, 2.0, -1e-9, 3.0), StationarityType::S);  // rounding
  EXPECT_EQ(type(1.0, 2.0, -1.0, 0.0), StationarityType::M);
  EXPECT_EQ(type(1.0, 2.0, -1.0, -3.0), StationarityType::C);
  EXPECT_EQ(type(0.0, -2.0, -1.0, -3.0), StationarityType::C);
  EXPECT_EQ(type(1.0, 2.0, -1.0, 3.0), StationarityType::A);
  EXPECT_EQ(type(1.0, -2.0, -1.0, -3.0), StationarityType::W);
  // Pairs that are not biactive have no say.
  const auto multipliers = of_pairs(linalg::Vector{-1.0, 1.0}, linalg::Vector{-1.0, 1.0});
  EXPECT_EQ(certificate::stationarity_type(multipliers, {false, true}, 1e-8), StationarityType::S);
}

}  // namespace
}  // namespace saltus::solver
