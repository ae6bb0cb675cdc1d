// Orders of elimination that are found for a matrix of which nothing is known.
#include "saltus/linalg/block_order.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "random_chains.hpp"
#include "saltus/linalg/block_ldl.hpp"
#include "saltus/linalg/fronts/pairs_internal.hpp"

namespace saltus::linalg {
namespace {

/// The same matrix with variables first, then equations, as interior points have them; returns how many these are.
int with_equations_last(ChainMatrix& a, const ChainShape& shape) {
  std::vector<bool> has_diagonal(static_cast<std::size_t>(a.size), false);
  for (std::size_t e = 0; e < a.rows.size(); ++e) {
    if (a.rows[e] == a.columns[e]) has_diagonal[static_cast<std::size_t>(a.rows[e])] = true;
  }
  EXPECT_EQ(shape.delta_c, 0.0);
  std::vector<int> number(static_cast<std::size_t>(a.size));
  int next = 0;
  for (const bool variables : {true, false}) {
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (has_diagonal[i] == variables) number[i] = next++;
    }
  }
  for (int& i : a.rows) i = number[static_cast<std::size_t>(i)];
  for (int& j : a.columns) j = number[static_cast<std::size_t>(j)];
  auto block = a.block;
  for (std::size_t i = 0; i < number.size(); ++i) block[static_cast<std::size_t>(number[i])] = a.block[i];
  a.block = block;
  return static_cast<int>(std::count(has_diagonal.begin(), has_diagonal.end(), false));
}

TEST(BlockOrder, has_the_inertia_and_about_the_cost_of_the_order_of_a_chain) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 10; ++trial) {
    const ChainShape shape{.elements = 40, .variables = 9, .equations = 6, .terminal = 2};
    auto a = ChainWriter(random, shape).run();
    const int equations = with_equations_last(a, shape);
    const auto block = blocks_by_minimum_degree(a.size, equations, a.rows, a.columns);
    ASSERT_EQ(std::ssize(block), a.size);
    std::map<int, int> rows;
    for (const int b : block) ++rows[b];
    for (const auto& [number, count] : rows) EXPECT_LE(count, 64);
    BlockLdl known, found;
    known.analyse(a.size, a.rows, a.columns, a.block);
    found.analyse(a.size, a.rows, a.columns, block);
    EXPECT_EQ(known.factorise(a.values), found.factorise(a.values));
    EXPECT_LE(found.multiplications(), 2.0 * known.multiplications());
  }
}

TEST(BlockOrder, divides_blocks_into_smaller_ones_that_cost_less) {
  std::mt19937 random(12);
  // Each element has four parts that meet in the first of its variables only.
  ChainMatrix a;
  constexpr int elements = 20, parts = 4, part = 12;
  const auto variables = [](int element) { return element * (parts * part + 1); };
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < elements; ++k) {
    const int first = variables(k);
    a.block.insert(a.block.end(), parts * part + 1, elements - 1 - k);
    a.size = static_cast<int>(a.block.size());
    a.add(first, first, 1.0);
    if (k > 0) a.add(first, variables(k - 1), unit(random));
    for (int p = 0; p < parts; ++p) {
      for (int i = 0; i < part; ++i) {
        const int row = first + 1 + p * part + i;
        a.add(row, first, unit(random));
        for (int j = 0; j <= i; ++j) a.add(row, row - i + j, unit(random));
      }
    }
  }
  BlockLdl whole, divided;
  whole.analyse(a.size, a.rows, a.columns, a.block);
  divided.analyse(a.size, a.rows, a.columns, divide_blocks(0, a.rows, a.columns, a.block));
  EXPECT_EQ(whole.factorise(a.values), divided.factorise(a.values));
  EXPECT_LE(divided.multiplications(), 0.25 * whole.multiplications());
}

TEST(BlockOrder, pairs_as_many_equations_with_variables_as_it_can) {
  // Equation 4 has variables 0 and 1, equation 5 only 0: the first has to leave 0 to the second.
  const std::vector<int> rows{0, 1, 4, 4, 5, 3}, columns{0, 1, 0, 1, 0, 2};
  const auto block = blocks_by_minimum_degree(6, 2, rows, columns);
  BlockLdl factors;
  factors.analyse(6, rows, columns, block);
  EXPECT_EQ(factors.factorise(std::vector<double>{1.0, 1.0, 1.0, 1.0, 1.0, 1.0}), (Inertia{3, 3, 0}));
  EXPECT_EQ(factors.delayed_rows(), 0);
}

TEST(BlockOrder, pairs_equations_with_variables_of_their_block_where_it_can) {
  // Equation 2 has variables 0, of a later block, and 1, of its own; equation 3 has only 1 in the second trial.
  const std::vector<int> rows{2, 2, 3}, columns{0, 1, 1}, block{1, 0, 0, 0};
  const auto first = [](const std::vector<int>& of, std::size_t count) { return std::span(of).first(count); };
  EXPECT_EQ(fronts::pair_equations(3, 1, first(rows, 2), first(columns, 2), first(block, 3)),
            (std::vector<int>{-1, 0}));
  EXPECT_EQ(fronts::pair_equations(4, 2, rows, columns, block), (std::vector<int>{0, 1}));
}

TEST(BlockOrder, of_nothing_is_nothing) { EXPECT_TRUE(blocks_by_minimum_degree(0, 0, {}, {}).empty()); }

}  // namespace
}  // namespace saltus::linalg
