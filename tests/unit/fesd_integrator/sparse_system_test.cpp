// Linear systems by their entries against dense ones.
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/fesd_integrator/element/sparse_system_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using linalg::Index;
using Unit = DenseSystem::Unit;
using Entries = std::vector<std::tuple<Index, Index, double>>;

/// A band of width 5 with entries of any size beside it, at places that depend on the seed.
Entries random_entries(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<Index> place(0, n - 1);
  Entries entries;
  for (Index i = 0; i < n; ++i) {
    for (Index j = std::max<Index>(0, i - 2); j < std::min(n, i + 3); ++j) entries.emplace_back(i, j, value(random));
    entries.emplace_back(i, place(random), 10.0 * value(random));
  }
  return entries;
}

template <class System>
void set_right(System& system, double factor) {
  for (Index i = 0; i < system.right().size(); ++i) system.right()(i) = factor * static_cast<double>(i % 7 - 3);
}

void fill(const Entries& entries, Index n, SparseSystem& sparse, DenseSystem& dense) {
  sparse.reset(n);
  dense.reserve(n);
  dense.reset(n);
  for (const auto& [i, j, value] : entries) {
    sparse.add(i, j, value);
    dense.matrix()(i, j) += value;
  }
}

TEST(SparseSystem, SolvesAsTheDenseOne) {
  SparseSystem sparse;  // one for all: sizes and places change from one to the next, and stay
  DenseSystem dense;
  for (const auto& [n, seed] : {std::pair<Index, unsigned>{40, 1}, {40, 1}, {40, 2}, {60, 2}, {40, 2}}) {
    fill(random_entries(n, seed), n, sparse, dense);
    set_right(sparse, 1.0);
    set_right(dense, 1.0);
    ASSERT_TRUE(sparse.solve(0.0, Unit::row));
    ASSERT_TRUE(dense.solve(0.0, Unit::row));
    EXPECT_TRUE(sparse.is_factorised());
    EXPECT_LT((sparse.right() - dense.right()).norm(), 1e-11 * dense.right().norm()) << n << ", " << seed;
    set_right(sparse, -2.5);
    set_right(dense, -2.5);
    ASSERT_TRUE(sparse.solve_again());
    ASSERT_TRUE(dense.solve_again());
    EXPECT_LT((sparse.right() - dense.right()).norm(), 1e-11 * dense.right().norm()) << n << ", " << seed;
    EXPECT_EQ(sparse.null_space().cols(), 0);
  }
}

TEST(SparseSystem, FewerEntriesThanBeforeAreAnotherMatrix) {
  SparseSystem system;
  system.reset(2);
  for (const auto& [i, j, value] : Entries{{0, 0, 2.0}, {1, 1, 4.0}, {0, 1, 8.0}}) system.add(i, j, value);
  system.right() = {10.0, 4.0};
  ASSERT_TRUE(system.solve(0.0, Unit::row));
  EXPECT_DOUBLE_EQ(system.right()(0), 1.0);
  system.reset(2);
  for (const auto& [i, j, value] : Entries{{0, 0, 2.0}, {1, 1, 4.0}}) system.add(i, j, value);
  system.right() = {10.0, 4.0};
  ASSERT_TRUE(system.solve(0.0, Unit::row));  // a diagonal
  EXPECT_DOUBLE_EQ(system.right()(0), 5.0);
  EXPECT_DOUBLE_EQ(system.right()(1), 1.0);
  system.right() = {1.0, 1.0};
  ASSERT_TRUE(system.solve_again());
  EXPECT_DOUBLE_EQ(system.right()(1), 0.25);
}

TEST(SparseSystem, ASingularOneHasTheSolutionOfLeastNorm) {
  // Rows n - 2 and n - 1 are the same but for a rounding.
  constexpr Index n = 30;
  for (const double difference : {0.0, 1e-15}) {
    SparseSystem sparse;
    DenseSystem dense;
    Entries entries;
    for (Index i = 0; i + 2 < n; ++i) entries.insert(entries.end(), {{i, i, 2.0}, {i, i + 1, 0.5}});
    for (const Index i : {n - 2, n - 1}) entries.insert(entries.end(), {{i, n - 2, 1.0}, {i, n - 1, 3.0}});
    entries.emplace_back(n - 1, n - 1, difference);
    fill(entries, n, sparse, dense);
    sparse.right().set_constant(1.0);
    dense.right().set_constant(1.0);
    ASSERT_TRUE(sparse.solve(1e-12, Unit::row));
    ASSERT_TRUE(dense.solve(1e-12, Unit::row));
    EXPECT_FALSE(sparse.is_factorised());
    EXPECT_EQ(sparse.null_space().cols(), 1);
    EXPECT_LT((sparse.right() - dense.right()).norm(), 1e-12);
  }
}

TEST(SparseSystem, SaysWhereThereIsNoSolution) {
  SparseSystem system;
  system.reset(2);
  for (const auto& [i, j, value] : Entries{{0, 0, 1.0}, {1, 0, 1.0}, {1, 1, 0.0}}) system.add(i, j, value);
  system.right() = {1.0, 2.0};
  EXPECT_FALSE(system.solve(0.0, Unit::row));
  system.reset(2);
  for (const auto& [i, j, value] : Entries{{0, 0, 1.0}, {1, 0, NAN}, {1, 1, 1.0}}) system.add(i, j, value);
  EXPECT_FALSE(system.solve(0.0, Unit::row));
}

}  // namespace
}  // namespace saltus::fesd_integrator
