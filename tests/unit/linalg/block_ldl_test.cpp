// Factors by blocks against eigenvalues of dense matrices, and what they cost.
#include "saltus/linalg/block_ldl.hpp"

#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "random_chains.hpp"
#include "saltus/linalg/spectra.hpp"

namespace saltus::linalg {
namespace {

using saltus::tests::allocations;

ChainMatrix chain(std::mt19937& random, const ChainShape& shape) { return ChainWriter(random, shape).run(); }

BlockLdl analysed(const ChainMatrix& a) {
  BlockLdl factors;
  factors.analyse(a.size, a.rows, a.columns, a.block);
  return factors;
}

/// Inertia by eigenvalues of the equilibrated matrix; none are counted where it is too near to a singular one to tell.
Inertia dense_inertia(Matrix a) {
  for (int round = 0; round < 5; ++round) {
    Vector scale(a.rows());
    for (Index i = 0; i < a.rows(); ++i) scale[i] = 1.0 / std::sqrt(a.row(i).max_abs());
    for (Index i = 0; i < a.rows(); ++i) {
      for (Index j = 0; j < a.cols(); ++j) a(i, j) *= scale[i] * scale[j];
    }
  }
  Inertia inertia;
  for (const double value : symmetric_eigenvalues(a)) {
    if (std::abs(value) < 1e-13) return {};
    ++(value > 0.0 ? inertia.positive : inertia.negative);
  }
  return inertia;
}

/// The largest residual of a row, relative to the sizes of its entries and of the solution, behind one refinement.
double backward_error(const ChainMatrix& a, BlockLdl& factors, const std::vector<double>& right) {
  auto x = right;
  factors.solve(x);
  auto step = a.residual(right, x);
  factors.solve(step);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += step[i];
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  std::vector<double> terms(x.size(), 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) terms[i] = std::abs(right[i]);
  for (std::size_t e = 0; e < a.values.size(); ++e) {
    const auto i = static_cast<std::size_t>(a.rows[e]), j = static_cast<std::size_t>(a.columns[e]);
    terms[i] += std::abs(a.values[e]) * largest;
    if (i != j) terms[j] += std::abs(a.values[e]) * largest;
  }
  const auto left = a.residual(right, x);
  double error = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) error = std::max(error, std::abs(left[i]) / terms[i]);
  return error;
}

ChainShape random_shape(std::mt19937& random) {
  const auto number = [&](int from, int to) { return std::uniform_int_distribution<int>(from, to)(random); };
  const int variables = number(2, 12);
  return {.elements = number(1, 12),
          .variables = variables,
          .equations = number(1, variables - 1),
          .inequalities = number(0, 3),
          .border = number(0, 3),
          .terminal = number(0, 3),
          .delta_c = number(0, 2) == 0 ? 1e-8 : 0.0};
}

TEST(BlockLdl, has_the_inertia_of_the_matrix_and_solves_with_it) {
  std::mt19937 random(1);
  int regular = 0;
  long delayed = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const auto a = chain(random, random_shape(random));
    const Inertia expected = dense_inertia(a.dense());
    if (expected == Inertia{}) continue;
    ++regular;
    auto factors = analysed(a);
    const Inertia inertia = factors.factorise(a.values);
    EXPECT_EQ(inertia, expected) << "trial " << trial << ": " << inertia.positive << " " << inertia.negative << " "
                                 << inertia.zero;
    delayed += factors.delayed_rows();
    std::vector<double> right(static_cast<std::size_t>(a.size));
    for (double& b : right) b = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    EXPECT_LE(backward_error(a, factors, right), 1e-14) << "trial " << trial;
  }
  EXPECT_GE(regular, 400);
  EXPECT_GT(delayed, 0);
}

TEST(BlockLdl, delays_rows_that_have_no_pivot_in_their_block) {
  // x0 and x1 in the first block without a Hessian, with two equations that only the next block can satisfy.
  ChainMatrix a;
  a.size = 4;
  a.block = {0, 0, 1, 1};
  a.add(2, 0, 1.0);
  a.add(3, 1, 1.0);
  auto factors = analysed(a);
  EXPECT_EQ(factors.factorise(a.values), (Inertia{2, 2, 0}));
  EXPECT_EQ(factors.delayed_rows(), 2);
  std::vector<double> x{1.0, 2.0, 3.0, 4.0};
  factors.solve(x);
  EXPECT_EQ(x, (std::vector<double>{3.0, 4.0, 1.0, 2.0}));
}

TEST(BlockLdl, adds_entries_of_one_place_and_takes_either_triangle) {
  const std::vector<int> rows{0, 1, 0, 1, 0}, columns{0, 0, 1, 1, 0}, block{7, 3};
  BlockLdl factors;
  factors.analyse(2, rows, columns, block);
  // 3 3; 3 1
  EXPECT_EQ(factors.factorise(std::vector<double>{1.0, 1.0, 2.0, 1.0, 2.0}), (Inertia{1, 1, 0}));
  std::vector<double> x{6.0, 4.0};
  factors.solve(x);
  EXPECT_NEAR(x[0], 1.0, 1e-15);
  EXPECT_NEAR(x[1], 1.0, 1e-15);
}

TEST(BlockLdl, names_the_rows_without_a_pivot) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    auto a = chain(random, {.elements = 4, .terminal = 0, .decades = 1.0});
    // A row of nothing, and an equation of a border variable that is stated twice.
    const int empty = a.size++, once = a.size++, twice = a.size++;
    a.block.insert(a.block.end(), {1, 4, 4});
    a.add(once, 0, 1.0);
    a.add(twice, 0, 1.0);
    auto factors = analysed(a);
    EXPECT_EQ(factors.factorise(a.values).zero, 2) << trial;
    const std::vector<int> rows(factors.rows_without_pivot().begin(), factors.rows_without_pivot().end());
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0], empty);
    EXPECT_TRUE(rows[1] == once || rows[1] == twice) << rows[1];
    // A right-hand side of a solution is solved nevertheless.
    std::vector<double> solution(static_cast<std::size_t>(a.size), 1.0), none(solution.size(), 0.0);
    solution[static_cast<std::size_t>(empty)] = solution[static_cast<std::size_t>(rows[1])] = 0.0;
    auto x = a.residual(none, solution);
    for (double& b : x) b = -b;
    factors.solve(x);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], solution[i], 1e-5);
  }
}

TEST(BlockLdl, of_numbers_that_are_not_finite_is_singular) {
  std::mt19937 random(3);
  auto a = chain(random, {});
  a.values[5] = std::numeric_limits<double>::quiet_NaN();
  auto factors = analysed(a);
  EXPECT_GT(factors.factorise(a.values).zero, 0);
}

TEST(BlockLdl, of_nothing_does_nothing) {
  BlockLdl factors;
  factors.analyse(0, {}, {}, {});
  EXPECT_EQ(factors.factorise({}), Inertia{});
  factors.solve({});
}

TEST(BlockLdl, gives_the_same_bits_twice_and_allocates_nothing_behind_the_first_time) {
  std::mt19937 random(4);
  const auto a = chain(random, {.elements = 30, .variables = 9, .equations = 6, .terminal = 3});
  auto factors = analysed(a);
  const std::vector<double> right(static_cast<std::size_t>(a.size), 1.0);
  auto first = right, second = right;
  const Inertia inertia = factors.factorise(a.values);
  factors.solve(first);
  const long before = allocations;
  EXPECT_EQ(factors.factorise(a.values), inertia);
  factors.solve(second);
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(first, second);
  auto others = analysed(a);
  EXPECT_EQ(others.factorise(a.values), inertia);
  second = right;
  others.solve(second);
  EXPECT_EQ(first, second);
}

TEST(BlockLdl, allocates_nothing_behind_the_analysis_where_nothing_is_delayed) {
  std::mt19937 random(5);
  auto a = chain(random, {.elements = 20, .equations = 2, .terminal = 0});
  for (int i = 0; i < a.size; ++i) a.add(i, i, a.block[static_cast<std::size_t>(i)] % 2 == 0 ? 100.0 : -100.0);
  auto factors = analysed(a);
  const long before = allocations;
  static_cast<void>(factors.factorise(a.values));
  std::vector<double>& x = a.values;
  factors.solve(std::span(x).first(static_cast<std::size_t>(a.size)));
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(factors.delayed_rows(), 0);
}

TEST(BlockLdl, costs_as_many_multiplications_per_element_however_many_there_are) {
  std::mt19937 random(6);
  const auto cost = [&](int elements) {
    const auto a = chain(random, {.elements = elements, .variables = 9, .equations = 6, .terminal = 0});
    auto factors = analysed(a);
    static_cast<void>(factors.factorise(a.values));
    return factors.multiplications() / elements;
  };
  const double few = cost(25);
  EXPECT_NEAR(cost(400), few, 0.1 * few);
}

TEST(BlockLdl, of_a_tree_of_blocks) {
  // Blocks 0 to 3 meet 4 or 5, which meet 6; 7 is alone.
  const std::vector<int> parent{4, 4, 5, 5, 6, 6, 6, 7};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ChainMatrix a;
  constexpr int rows = 3;
  for (int b = 0; b < 8; ++b) {
    for (int i = 0; i < rows; ++i) a.block.push_back(b);
  }
  a.size = static_cast<int>(a.block.size());
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j <= i; ++j) {
      const int early = a.block[static_cast<std::size_t>(j)], late = a.block[static_cast<std::size_t>(i)];
      if (early == late || parent[static_cast<std::size_t>(early)] == late) a.add(i, j, unit(random));
    }
  }
  auto factors = analysed(a);
  EXPECT_EQ(factors.factorise(a.values), dense_inertia(a.dense()));
  EXPECT_LE(backward_error(a, factors, std::vector<double>(static_cast<std::size_t>(a.size), 1.0)), 1e-14);
}

}  // namespace
}  // namespace saltus::linalg
