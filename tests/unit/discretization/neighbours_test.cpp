// Prices of mode sequences beside a solved branch, against differences of optima.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

TEST(InsertionPrices, SayWhatARestAtTheEndChanges) {
  expect_prices(block("horizon = 4\nrunning_cost = \"u^2\"\nterminal_constraints = [\"q == 0.2\"]\n"));
}

/// Friction stops a block at t = 1, within the second of four intervals; its motion, and what multipliers would say.
class Neighbours : public testing::Test {
 protected:
  explicit Neighbours(const std::string& dynamics = "u - sign(v)", double velocity = 1.0)
      : stated_(stated_problem(
            "[model]\nname = \"block\"\n[states]\nq = 0\nv = " + std::to_string(velocity) +
            "\n[controls]\nu = { lower = -8, upper = 8, initial = 0 }\n[dynamics]\nq = \"v\"\nv = \"" + dynamics +
            "\"\n[optimize]\nhorizon = 2.4\ncontrol_intervals = 4\nelements = 3\n"
            "running_cost = \"u^2\"\n")),
        problem_(*stated_.problem) {
    const auto motion = problem_.motion(problem_.start(), [] { return false; });
    EXPECT_TRUE(motion);
    sides_ = motion->sides;
    w_ = motion->w;
    const auto zero = [](int count) { return linalg::Vector(linalg::Vector::zero(count)); };
    multipliers_.rows = zero(problem_.constraints());
    multipliers_.G = multipliers_.H = zero(problem_.pairs());
    multipliers_.lower = multipliers_.upper = zero(problem_.variables());
  }

  [[nodiscard]] int length(int interval, int number) const {
    const auto name = "h[" + std::to_string(interval) + "," + std::to_string(number) + "]";
    int variable = 0;
    while (problem_.name(variable) != name) ++variable;
    return variable;
  }
  void set_lengths(int interval, const std::vector<double>& shares) {
    for (int n = 0; n < 3; ++n) w_[length(interval, n)] = shares[at(n)];
  }
  /// Sides of an element, in a text: one letter per pair.
  [[nodiscard]] std::string modes(const std::vector<mpcc::ActiveSide>& sides, int interval, int number) const {
    const auto pairs = problem_.chain()->elements[at(3 * interval + number)].pairs;
    std::string text;
    for (int i = 0; i < pairs.count; ++i) text += sides[at(pairs.first + i)] == mpcc::ActiveSide::G ? 'G' : 'H';
    return text;
  }
  void set_modes(int interval, int number, int from_interval, int from_number) {
    const auto to = problem_.chain()->elements[at(3 * interval + number)].pairs;
    const auto from = problem_.chain()->elements[at(3 * from_interval + from_number)].pairs;
    std::copy_n(sides_.begin() + from.first, from.count, sides_.begin() + to.first);
  }
  [[nodiscard]] std::vector<mpcc::BranchMove> moves(const std::string& name) {
    auto list = problem_.neighbours(sides_, w_, multipliers_);
    std::erase_if(list, [&](const mpcc::BranchMove& move) { return move.name != name; });
    return list;
  }
  void expect_modes(const mpcc::BranchMove& move, int interval, const std::vector<std::string>& expected) const {
    for (int n = 0; n < 3; ++n) EXPECT_EQ(modes(move.sides, interval, n), expected[at(n)]) << interval << " " << n;
  }

  pipeline::StatedProblem stated_;
  OcpProblem& problem_;
  std::vector<mpcc::ActiveSide> sides_;
  linalg::Vector w_;
  mpcc::Multipliers multipliers_;
};

/// The block slides in all of the second interval but an element of length zero.
TEST_F(Neighbours, RemoveAnElementOfLengthZeroAndShiftItOverTheNode) {
  set_modes(1, 1, 0, 0);
  set_modes(1, 2, 2, 0);
  set_lengths(1, {0.5, 0.5, 0.0});
  const std::string slides = modes(sides_, 0, 0), rests = modes(sides_, 2, 0);
  const auto removals = moves("removal"), shifts = moves("shift");
  ASSERT_EQ(removals.size(), 1U);
  expect_modes(removals.front(), 1, {slides, slides, slides});
  EXPECT_NEAR(removals.front().start[length(1, 2)], 1.0 / 3.0, 1e-12);
  EXPECT_TRUE(removals.front().is_simpler && !shifts.front().is_simpler);
  ASSERT_EQ(shifts.size(), 2U);
  expect_modes(shifts[0], 1, {slides, slides, rests});
  EXPECT_NEAR(shifts[0].start[length(1, 2)], small_share, 1e-3);
  expect_modes(shifts[1], 1, {slides, slides, slides});
  expect_modes(shifts[1], 2, {slides, rests, rests});
  for (const auto* list : {&removals, &shifts}) {
    for (const auto& move : *list) EXPECT_FALSE(move.price);
  }
}

TEST_F(Neighbours, SplitAStretchThatIsAsLongAsItMayBe) {
  set_modes(1, 1, 2, 0);
  set_lengths(1, {2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0});
  multipliers_.upper[length(1, 0)] = 5.0;
  const std::string slides = modes(sides_, 0, 0), rests = modes(sides_, 2, 0);
  const auto splits = moves("split");
  ASSERT_EQ(splits.size(), 1U);
  expect_modes(splits.front(), 1, {slides, slides, rests});
  EXPECT_NEAR(splits.front().start[length(1, 2)], 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(splits.front().price.value_or(0.0), -5.0 * inserted_share, 1e-12);
}

/// |v| v is 0 at rest, whatever the sign of v.
class NeighboursOfARest : public Neighbours {
 protected:
  NeighboursOfARest() : Neighbours("u - abs(v)*v", 0.0) {}
};

TEST_F(NeighboursOfARest, FlipWhatIsHeldWithoutNeed) {
  multipliers_.G = multipliers_.H = linalg::Vector::constant(problem_.pairs(), -1.0);
  const auto flips = moves("flip");
  EXPECT_EQ(flips.size(), 24U);  // on either side up to each of twelve boundaries, on the other one behind
  for (const auto& move : flips) {
    EXPECT_LE(solver::certificate::scaled_infeasibility(problem_, move.start), 1e-8);
    EXPECT_LE(solver::certificate::complementarity(problem_, move.start), 1e-8);
    EXPECT_NEAR(move.price.value_or(0.0), -inserted_share * inserted_share, 1e-15);
  }
}

}  // namespace
}  // namespace saltus::discretization
