#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../../mpcc/polynomial_problem.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/homotopy/follow_path.hpp"

namespace saltus::solver {
namespace {

using homotopy::PathOptions;
using homotopy::Relaxation;
using mpcc::PolynomialProblem;
using mpcc::PolynomialStatement;
using result::Termination;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Rosenbrock's function under w0 w1 >= 1, w0 <= 0.5: the solution (0.5, 2) lies on both (problem 15 of Hock and
/// Schittkowski), f = 306.5.
PolynomialProblem hock_schittkowski_15() {
  PolynomialStatement statement;
  statement.variables = 2;
  statement.f = {{{100.0, {4}}, {-200.0, {2, 1}}, {100.0, {0, 2}}, {1.0, {2}}, {-2.0, {1}}, {1.0, {}}}};
  statement.g = {{{{1.0, {1, 1}}}}, {{{1.0, {1}}, {1.0, {0, 2}}}}};
  statement.g_bounds = {linalg::Vector{1.0, 0.0}, linalg::Vector{infinity, infinity}};
  statement.w_bounds = {linalg::Vector{-infinity, -infinity}, linalg::Vector{0.5, infinity}};
  return PolynomialProblem(statement);
}

TEST(Ipopt, SolvesANonlinearProgramWithMultipliers) {
  auto problem = hock_schittkowski_15();
  adapters::IpoptSolver solver;
  NlpPoint point{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  const NlpReport report = solver.solve(problem, point, {});
  EXPECT_EQ(report.termination, Termination::completed) << report.message;
  EXPECT_NEAR(point.w[0], 0.5, 1e-10);
  EXPECT_NEAR(point.w[1], 2.0, 1e-10);
  EXPECT_NEAR(report.objective, 306.5, 1e-8);
  // grad f = (-351, 350) + y (2, 0.5)' + z_upper (1, 0)' = 0 with the signs of NlpPoint.
  EXPECT_NEAR(point.y[0], -700.0, 1e-5);
  EXPECT_NEAR(point.z_upper[0], 351.0 + 1400.0, 1e-5);
  EXPECT_GT(report.iterations, 2);

  // From the solution with its multipliers and a small barrier parameter little is left to do.
  const NlpReport again = solver.solve(problem, point, {.time_limit = {}, .first_barrier_mu = 1e-9});
  EXPECT_EQ(again.termination, Termination::completed);
  EXPECT_LE(again.iterations, 3);
}

TEST(Ipopt, SaysWhatWentWrong) {
  adapters::IpoptSolver solver;
  auto problem = hock_schittkowski_15();
  NlpPoint point{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  EXPECT_EQ(solver.solve(problem, point, {.iteration_limit = 2, .time_limit = {}, .first_barrier_mu = {}}).termination,
            Termination::iteration_limit);

  PolynomialStatement contradiction;  // w^2 = -1
  contradiction.variables = 2;
  contradiction.f = {{{1.0, {0, 2}}}};
  contradiction.g = {{{{1.0, {2}}}}};
  contradiction.g_bounds = {linalg::Vector::constant(1, -1.0), linalg::Vector::constant(1, -1.0)};
  PolynomialProblem infeasible(contradiction);
  NlpPoint start{.w = linalg::Vector{1.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  EXPECT_EQ(solver.solve(infeasible, start, {}).termination, Termination::infeasible);

  PolynomialStatement undefined;  // 1/w at 0
  undefined.variables = 1;
  undefined.f = {{{1.0, {-1}}}};
  undefined.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  PolynomialProblem singular(undefined);
  NlpPoint zero{.w = linalg::Vector::zero(1), .y = {}, .z_lower = {}, .z_upper = {}};
  EXPECT_EQ(solver.solve(singular, zero, {}).termination, Termination::evaluation_failed);
}

TEST(Ipopt, GivesUpWhereTheObjectiveIsOfNoUse) {
  adapters::IpoptSolver solver;
  auto problem = hock_schittkowski_15();
  NlpOptions options;
  for (const double cutoff : {300.0, 310.0}) {
    NlpPoint point{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
    options.objective_cutoff = cutoff;  // the optimum is 306.5
    const NlpReport report = solver.solve(problem, point, options);
    EXPECT_EQ(report.termination, cutoff > 306.5 ? Termination::completed : Termination::not_converged) << cutoff;
    EXPECT_EQ(report.objective > cutoff, cutoff < 306.5);
  }
}

TEST(Ipopt, SameProblemTwiceSameBits) {
  auto problem = hock_schittkowski_15();
  const NlpPoint start{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  adapters::IpoptSolver solver;
  NlpPoint first = start;
  NlpPoint second = start;
  EXPECT_EQ(solver.solve(problem, first, {}).termination, Termination::completed);
  EXPECT_EQ(solver.solve(problem, second, {}).termination, Termination::completed);  // with the structures of the first
  EXPECT_EQ(first.w, second.w);
  EXPECT_EQ(first.y, second.y);
}

TEST(Ipopt, OtherProblemsBeforeLeaveNoTrace) {
  auto problem = hock_schittkowski_15();
  const NlpPoint start{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  NlpPoint fresh = start;
  EXPECT_EQ(adapters::IpoptSolver().solve(problem, fresh, {}).termination, Termination::completed);

  PolynomialStatement line;  // of another size, and one that fails: w = 1 and w = 2
  line.variables = 1;
  line.f = {{{1.0, {2}}}};
  line.g = {{{{1.0, {1}}}}};
  line.g_bounds = {linalg::Vector::ones(1), linalg::Vector::constant(1, infinity)};
  PolynomialProblem other(line);
  line.g = {{{{1.0, {1}}}}, {{{1.0, {1}}}}};
  line.g_bounds = {linalg::Vector{1.0, 2.0}, linalg::Vector{1.0, 2.0}};
  PolynomialProblem impossible(line);
  adapters::IpoptSolver solver;
  for (PolynomialProblem* before : {&other, &impossible, &other}) {
    NlpPoint point{.w = linalg::Vector::zero(1), .y = {}, .z_lower = {}, .z_upper = {}};
    const NlpReport report = solver.solve(*before, point, {});
    EXPECT_EQ(report.termination == Termination::completed, before == &other);
    NlpPoint again = start;
    EXPECT_EQ(solver.solve(problem, again, {.iteration_limit = 3}).termination, Termination::iteration_limit);
    again = start;
    EXPECT_EQ(solver.solve(problem, again, {}).termination, Termination::completed);
    EXPECT_EQ(again.w, fresh.w);
    EXPECT_EQ(again.y, fresh.y);
  }
}

TEST(Ipopt, KeepsAFeasibleIterateWhereTheLimitEndsIt) {
  // From beside its maximum w0 = 0 the point slides down w1 = 10 w0^2 in growing steps, each of which leaves the
  // parabola.
  PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{-1e-2, {2}}, {1e-2, {4}}, {1.0, {0, 0, 1}}}};
  statement.g = {{{{1.0, {0, 1}}, {-10.0, {2}}}}};
  statement.g_bounds = {linalg::Vector::zero(1), linalg::Vector::zero(1)};
  statement.w_bounds = {linalg::Vector{-infinity, -infinity, 0.0}, linalg::Vector::constant(3, infinity)};
  PolynomialProblem problem(statement);
  adapters::IpoptSolver solver;
  bool was_feasible = false;
  int left = 0;
  for (int limit = 1; limit < 60; ++limit) {
    NlpPoint point{.w = linalg::Vector{1e-6, 1e-11, 1e-3}, .y = {}, .z_lower = {}, .z_upper = {}};
    const NlpReport report = solver.solve(problem, point, {.iteration_limit = limit});
    if (report.termination != Termination::iteration_limit) break;
    const bool is_feasible = std::abs(point.w[1] - 10.0 * point.w[0] * point.w[0]) <= 1e-9;
    if (was_feasible && !is_feasible) ++left;
    was_feasible = is_feasible && point.w[2] < 1e-7;
  }
  EXPECT_TRUE(was_feasible);
  EXPECT_EQ(left, 0);
}

TEST(Ipopt, StopsBetweenIterations) {
  auto problem = hock_schittkowski_15();
  adapters::IpoptSolver solver;
  NlpPoint point{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  int asked = 0;
  NlpOptions options;
  options.is_interrupted = [&asked] { return ++asked > 3; };
  const NlpReport report = solver.solve(problem, point, options);
  EXPECT_EQ(report.termination, Termination::stopped_by_user);
  EXPECT_LE(report.iterations, 3);
  EXPECT_GE(report.evaluation_seconds, 0.0);
  EXPECT_TRUE(point.w.all_finite());
}

/// min (w0 - 2)^2 + (w1 - 1)^2 with w0 w1 <= sigma, w >= 0: for sigma -> 0 the point (2, 0).
class ProductBelow final : public PolynomialProblem {
 public:
  ProductBelow() : PolynomialProblem(statement()) {}
  static PolynomialStatement statement() {
    PolynomialStatement made;
    made.variables = 2;
    made.f = {{{5.0, {}}, {-4.0, {1}}, {1.0, {2}}, {-2.0, {0, 1}}, {1.0, {0, 2}}}};
    made.w_bounds = {linalg::Vector::zero(2), linalg::Vector::constant(2, 10.0)};
    made.g = {{{{1.0, {1, 1}}}}};
    made.g_bounds = {linalg::Vector::constant(1, -infinity), linalg::Vector::zero(1)};
    return made;
  }
  void functions(mpcc::ConstVectorView w, mpcc::VectorView c) override {
    PolynomialProblem::functions(w, c);
    c[0] -= sigma;
  }
  double sigma = 1.0;
};

TEST(IpoptLoop, FollowsAParameterInOneGo) {
  ProductBelow problem;
  adapters::IpoptSolver solver;
  NlpPoint point{.w = linalg::Vector{1.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  std::vector<NlpPoint> solved;
  const auto next = [&](const NlpPoint& at, double mu, int /*iterations*/) -> std::optional<NextBarrier> {
    if (mu > 1e-2 * problem.sigma) return NextBarrier{.mu = 0.1 * mu, .is_changed = false};
    solved.push_back(at);
    EXPECT_NEAR(at.w[0] * at.w[1], problem.sigma, 0.2 * problem.sigma);
    if (problem.sigma < 1e-7) return std::nullopt;
    problem.sigma *= 0.1;
    return NextBarrier{.mu = 1e-2 * problem.sigma, .is_changed = true};
  };
  const NlpReport report = solver.follow(problem, point, {}, 0.1, 50, next);
  EXPECT_EQ(report.termination, Termination::completed) << report.message;
  ASSERT_EQ(solved.size(), 9u);
  EXPECT_LT(report.iterations, 60);
  EXPECT_NEAR(point.w[0], 2.0, 1e-6);
  EXPECT_NEAR(point.w[1], 0.0, 1e-6);
  EXPECT_NEAR(point.y[0] * point.w[0], 2.0, 0.1);  // of the product: d/dw1, as far as 10 mu goes
}

TEST(IpoptLoop, OtherProblemsMayBeSolvedMeanwhile) {
  ProductBelow problem;
  adapters::IpoptSolver solver;
  NlpPoint alone{.w = linalg::Vector{1.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  NlpPoint beside = alone;
  const auto follow = [&](NlpPoint& point, bool has_others) {
    problem.sigma = 1.0;
    return solver.follow(problem, point, {}, 0.1, 50,
                         [&](const NlpPoint&, double mu, int) -> std::optional<NextBarrier> {
                           if (has_others) {
                             auto other = hock_schittkowski_15();
                             NlpPoint of_other{.w = linalg::Vector{-2.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
                             EXPECT_EQ(solver.solve(other, of_other, {}).termination, Termination::completed);
                           }
                           if (mu < 1e-8) return std::nullopt;
                           problem.sigma *= 0.2;
                           return NextBarrier{.mu = 0.2 * mu, .is_changed = true};
                         });
  };
  EXPECT_EQ(follow(alone, false).iterations, follow(beside, true).iterations);
  EXPECT_EQ(alone.w[0], beside.w[0]);
  EXPECT_EQ(alone.w[1], beside.w[1]);
}

TEST(IpoptLoop, EndsWhereABarrierProblemTakesTooLong) {
  ProductBelow problem;
  adapters::IpoptSolver solver;
  NlpPoint point{.w = linalg::Vector{1.0, 1.0}, .y = {}, .z_lower = {}, .z_upper = {}};
  const auto same = [](const NlpPoint&, double mu, int) { return std::optional(NextBarrier{.mu = 0.1 * mu}); };
  const NlpReport report = solver.follow(problem, point, {}, 0.1, 2, same);
  EXPECT_EQ(report.termination, Termination::step_size_too_small);
  EXPECT_NE(report.message.find("too long"), std::string::npos);
  EXPECT_TRUE(point.w.all_finite());

  NlpOptions interrupted;
  interrupted.is_interrupted = [] { return true; };
  EXPECT_EQ(solver.follow(problem, point, interrupted, 0.1, 50, same).termination, Termination::stopped_by_user);
}

class EveryRelaxation : public testing::TestWithParam<Relaxation> {
 protected:
  homotopy::PathResult follow(mpcc::Problem& problem, const linalg::Vector& start) {
    PathOptions options;
    options.relaxation = GetParam();
    adapters::IpoptSolver solver;
    auto path = homotopy::follow_path(problem, start, solver, options);
    EXPECT_TRUE(path.has_value());
    EXPECT_EQ(path->termination, Termination::completed) << path->message;
    EXPECT_LE(path->residuals.complementarity_product, options.complementarity_tolerance);
    return *path;
  }
};

/// A point of a relaxation with a b <= sigma = 1e-10 is within sqrt(sigma) = 1e-5 of the complementary ones, and where
/// only one side is zero, within sigma over the other side; there the acceptable tolerance of the solver, 1e-6 in the
/// gradient of functions with curvature 2, is what is left.
constexpr double strictly = 1e-6;
constexpr double biactive = 2e-5;

TEST_P(EveryRelaxation, MinimumOnOneAxis) {
  PolynomialStatement statement;  // (w0 - 1)^2 + w1^3 + w1^2
  statement.variables = 2;
  statement.f = {{{1.0, {2}}, {-2.0, {1}}, {1.0, {}}, {1.0, {0, 3}}, {1.0, {0, 2}}}};
  statement.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  statement.G = {{{{1.0, {1}}}}};
  statement.H = {{{{1.0, {0, 1}}}}};
  PolynomialProblem problem(statement);
  const auto path = follow(problem, linalg::Vector{0.0, 5.0});
  EXPECT_NEAR(path.point.w[0], 1.0, strictly);
  EXPECT_NEAR(path.point.w[1], 0.0, biactive);  // f grows with its square only: 1e-5 costs 1e-10
}

TEST_P(EveryRelaxation, BiactiveMinimumOfLinearProblem) {
  // min w0 + w1 - w2, 4 w0 >= w2, 4 w1 >= w2, 0 <= w0 _|_ w1 >= 0: feasible points have w2 <= 0, so the origin is the
  // minimum; it is no strongly stationary point, which is what makes it hard (problem scholtes4 of MacMPEC).
  PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{1.0, {1}}, {1.0, {0, 1}}, {-1.0, {0, 0, 1}}}};
  statement.g = {{{{4.0, {1}}, {-1.0, {0, 0, 1}}}}, {{{4.0, {0, 1}}, {-1.0, {0, 0, 1}}}}};
  statement.g_bounds = {linalg::Vector::zero(2), linalg::Vector::constant(2, infinity)};
  statement.G = {{{{1.0, {1}}}}};
  statement.H = {{{{1.0, {0, 1}}}}};
  PolynomialProblem problem(statement);
  const auto path = follow(problem, linalg::Vector{0.0, 1.0, 0.0});
  // On the boundary of the relaxed set w0 = w1 = sqrt(sigma), w2 = 4 sqrt(sigma), with sigma <= 1e-9.
  EXPECT_NEAR(path.point.w.norm(), 0.0, 6.0 * std::sqrt(1e-9));
}

TEST_P(EveryRelaxation, FollowerInABilevelProblem) {
  // The leader minimises (x - 5)^2 + (2y + 1)^2, the follower (y - 1)^2 - 1.5 x y subject to three constraints
  // (Bard 1988; bard1 of MacMPEC): x = 1, y = 0, value 17.
  PolynomialStatement statement;  // w = (x, y, l1, l2, l3)
  statement.variables = 5;
  statement.f = {{{1.0, {2}}, {-10.0, {1}}, {25.0, {}}, {4.0, {0, 2}}, {4.0, {0, 1}}, {1.0, {}}}};
  statement.g = {
      {{{2.0, {0, 1}}, {-2.0, {}}, {-1.5, {1}}, {1.0, {0, 0, 1}}, {-0.5, {0, 0, 0, 1}}, {1.0, {0, 0, 0, 0, 1}}}}};
  statement.g_bounds = {linalg::Vector::zero(1), linalg::Vector::zero(1)};
  // 3x - y - 3 >= 0, -x + y/2 + 4 >= 0, -x - y + 7 >= 0
  statement.G = {{{{3.0, {1}}, {-1.0, {0, 1}}, {-3.0, {}}}},
                 {{{-1.0, {1}}, {0.5, {0, 1}}, {4.0, {}}}},
                 {{{-1.0, {1}}, {-1.0, {0, 1}}, {7.0, {}}}}};
  statement.H = {{{{1.0, {0, 0, 1}}}}, {{{1.0, {0, 0, 0, 1}}}}, {{{1.0, {0, 0, 0, 0, 1}}}}};
  statement.w_bounds = {linalg::Vector::constant(5, -infinity), linalg::Vector::constant(5, infinity)};
  statement.w_bounds.lower.head(2).set_zero();
  PolynomialProblem problem(statement);
  const auto path = follow(problem, linalg::Vector::ones(5));
  EXPECT_NEAR(path.point.w[0], 1.0, strictly);
  EXPECT_NEAR(path.point.w[1], 0.0, strictly);
  EXPECT_NEAR(path.point.w[2], 3.5, strictly);
  EXPECT_NEAR(problem.objective(path.point.w), 17.0, 10 * strictly);
}

INSTANTIATE_TEST_SUITE_P(All, EveryRelaxation, testing::ValuesIn(homotopy::all_relaxations),
                         [](const auto& test) { return std::string(homotopy::name(test.param)); });

TEST(Homotopy, NoSolutionIsNotCalledOne) {
  PolynomialStatement statement;  // 0 <= w0 _|_ w1 >= 0 with w0 w1 = 1
  statement.variables = 2;
  statement.f = {{{1.0, {1}}}};
  statement.g = {{{{1.0, {1, 1}}}}};
  statement.g_bounds = {linalg::Vector::ones(1), linalg::Vector::ones(1)};
  statement.G = {{{{1.0, {1}}}}};
  statement.H = {{{{1.0, {0, 1}}}}};
  PolynomialProblem problem(statement);
  adapters::IpoptSolver solver;
  const auto path = homotopy::follow_path(problem, linalg::Vector{1.0, 1.0}, solver, {});
  ASSERT_TRUE(path.has_value());
  EXPECT_NE(path->termination, Termination::completed);
  EXPECT_FALSE(path->message.empty());
  EXPECT_GT(path->residuals.infeasibility(), 0.1);
}

TEST(Homotopy, ScheduleEndsAtItsLastSigma) {
  auto problem = hock_schittkowski_15();
  adapters::IpoptSolver solver;
  PathOptions options;
  options.complementarity_tolerance = 1e-300;
  options.schedule = {.sigma_initial = 0.5, .sigma_factor = 0.2, .sigma_final = 3e-3};
  std::vector<double> sigmas;
  PolynomialStatement pair;
  pair.variables = 2;
  pair.f = {{{-1.0, {1}}, {-1.0, {0, 1}}, {0.5, {2}}, {0.5, {0, 2}}}};
  pair.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  pair.G = {{{{1.0, {1}}}}};
  pair.H = {{{{1.0, {0, 1}}}}};
  PolynomialProblem unreachable(pair);
  const auto path = homotopy::follow_path(unreachable, linalg::Vector{0.3, 0.4}, solver, options,
                                          [&](const homotopy::PathStep& step) {
                                            sigmas.push_back(step.sigma);
                                            return true;
                                          });
  ASSERT_TRUE(path.has_value());
  ASSERT_EQ(sigmas.size(), 5u);
  const double expected[] = {0.5, 0.1, 0.02, 0.004, 0.003};
  for (std::size_t i = 0; i < sigmas.size(); ++i) EXPECT_DOUBLE_EQ(sigmas[i], expected[i]);
  EXPECT_EQ(path->termination, Termination::verification_failed);

  const auto stopped = homotopy::follow_path(unreachable, linalg::Vector{0.3, 0.4}, solver, options,
                                             [](const homotopy::PathStep& step) { return step.sigma > 0.05; });
  EXPECT_EQ(stopped->termination, Termination::stopped_by_user);
  EXPECT_EQ(stopped->steps.size(), 3u);
}

TEST(Homotopy, RefusesOptionsOutOfRange) {
  auto problem = hock_schittkowski_15();
  adapters::IpoptSolver solver;
  const auto refused = [&](const PathOptions& options) {
    return !homotopy::follow_path(problem, linalg::Vector{-2.0, 1.0}, solver, options).has_value();
  };
  PathOptions options;
  EXPECT_FALSE(refused(options));
  for (const homotopy::Schedule schedule : {homotopy::Schedule{-1.0, 0.1, 1e-9},
                                            {1.0, 1.0, 1e-9},
                                            {1.0, 0.1, 0.0},
                                            {1.0, 0.1, 2.0},
                                            {infinity, 0.1, 1e-9}}) {
    options.schedule = schedule;
    EXPECT_TRUE(refused(options));
  }
}

}  // namespace
}  // namespace saltus::solver
