// Sparse matrices and their factors against dense ones.
#include "saltus/linalg/sparse.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "random_matrices.hpp"
#include "saltus/linalg/sparse_factors.hpp"

namespace saltus::linalg {
namespace {

/// Some three entries in each row, and some places met twice.
std::vector<Triplet> random_entries(std::mt19937& random, Index rows, Index columns) {
  std::uniform_int_distribution<Index> row(0, rows - 1), column(0, columns - 1);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Triplet> entries;
  for (Index k = 0; k < 3 * rows; ++k) entries.push_back({row(random), column(random), value(random)});
  entries.push_back(entries.front());
  return entries;
}

Matrix dense_of(Index rows, Index columns, const std::vector<Triplet>& entries) {
  Matrix matrix = Matrix::zero(rows, columns);
  for (const Triplet& entry : entries) matrix(entry.row, entry.column) += entry.value;
  return matrix;
}

/// Random, with a diagonal that keeps it from being singular.
SparseColumns random_square(std::mt19937& random, Index n) {
  auto entries = random_entries(random, n, n);
  for (Index i = 0; i < n; ++i) entries.push_back({i, i, 3.0});
  return {n, n, entries};
}

template <Major major>
void expect_as_dense(std::mt19937& random, Index rows, Index columns) {
  const auto entries = random_entries(random, rows, columns);
  const Matrix dense = dense_of(rows, columns, entries);
  Sparse<major> sparse(rows, columns, entries);
  EXPECT_LE(distance(sparse.dense(), dense), 1e-15);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) EXPECT_NEAR(sparse(i, j), dense(i, j), 1e-15);
  }
  for (Index o = 0; o < sparse.outer_size(); ++o) {
    int last = -1;
    for (const Entry entry : sparse.along(o)) {
      EXPECT_LT(last, entry.inner);
      last = entry.inner;
    }
  }
  const Matrix x = random_matrix(random, columns, 2), y = random_matrix(random, rows, 2);
  EXPECT_LE(distance(sparse * x, dense * x), 1e-14);
  EXPECT_LE(distance(sparse.transposed_times(y), dense.transpose() * y), 1e-14);
  EXPECT_LE(distance(sparse.transposed().dense(), dense.transpose()), 1e-15);
  EXPECT_LE(distance(sparse.diagonal(), dense.diagonal()), 1e-15);
  EXPECT_NEAR(sparse.norm(), dense.norm(), 1e-14);
  EXPECT_TRUE(Sparse<major>(rows, columns, sparse.triplets()).dense() == sparse.dense());
  const Vector factors = random_matrix(random, rows, 1);
  sparse.scale_rows(factors);
  EXPECT_LE(distance(sparse.dense(), scaled_rows(factors, dense)), 1e-15);
  EXPECT_TRUE(sparse.all_finite());
  sparse.values()[0] = INFINITY;
  EXPECT_FALSE(sparse.all_finite());
}

TEST(Sparse, IsAsTheDenseOne) {
  std::mt19937 random(1);
  for (const auto& [rows, columns] : std::vector<std::pair<Index, Index>>{{1, 1}, {4, 7}, {12, 5}, {20, 20}}) {
    expect_as_dense<Major::columns>(random, rows, columns);
    expect_as_dense<Major::rows>(random, rows, columns);
  }
  EXPECT_EQ(SparseColumns(3, 4).entries(), 0);
  EXPECT_TRUE(SparseRows(3, 4).dense().is_zero());
  EXPECT_EQ(SparseColumns().outer_size(), 0);
}

TEST(Sparse, HasSumsAndProducts) {
  std::mt19937 random(2);
  const SparseColumns a(6, 8, random_entries(random, 6, 8)), b(6, 8, random_entries(random, 6, 8));
  const SparseColumns c(8, 3, random_entries(random, 8, 3));
  EXPECT_LE(distance((a + b).dense(), a.dense() + b.dense()), 1e-15);
  EXPECT_LE(distance((a * c).dense(), a.dense() * c.dense()), 1e-14);
}

TEST(SparseLu, SolvesAsTheDenseOneDoes) {
  std::mt19937 random(3);
  for (const Index n : {1, 2, 10, 80}) {
    const SparseColumns a = random_square(random, n);
    const Matrix b = random_matrix(random, n, 2);
    const SparseLu factors(a);
    ASSERT_TRUE(factors.is_factorised()) << n;
    EXPECT_LE(distance(factors.solve(b), Lu(a.dense()).solve(b)), 1e-11) << n;
    const double expected = determinant(a.dense());
    EXPECT_EQ(factors.sign_of_determinant(), expected > 0.0 ? 1.0 : -1.0) << n;
    EXPECT_NEAR(factors.log_abs_determinant(), std::log(std::abs(expected)), 1e-10) << n;
    // Rows of a view with steps.
    EXPECT_LE(distance(factors.solve(Matrix(b.transpose()).transpose()), factors.solve(b)), 1e-14);
  }
}

TEST(SparseLu, TakesOtherValuesAtTheSamePlaces) {
  std::mt19937 random(4);
  SparseColumns a = random_square(random, 30);
  const Vector b = random_matrix(random, 30, 1);
  SparseLu factors;
  factors.analyse(a);
  EXPECT_FALSE(factors.is_factorised());
  for (int k = 0; k < 3; ++k) {
    for (double& value : a.values()) value *= 1.5;
    ASSERT_TRUE(factors.factorise(a));
    EXPECT_LE(distance(a * factors.solve(b), b), 1e-11);
  }
  // A copy begins without factors, at the same places.
  SparseLu copy = factors;
  EXPECT_FALSE(copy.is_factorised());
  ASSERT_TRUE(copy.factorise(a));
  EXPECT_LE(distance(copy.solve(b), factors.solve(b)), 1e-13);
}

TEST(SparseLu, TellsSingularMatrices) {
  const std::vector<Triplet> no_last_column{{0, 0, 1.0}, {1, 0, 1.0}, {0, 1, 0.0}, {1, 1, 0.0}};
  SparseLu factors;
  EXPECT_FALSE(factors.compute({2, 2, no_last_column}));
  EXPECT_FALSE(factors.is_factorised());
  const std::vector<Triplet> same_rows{{0, 0, 1.0}, {0, 1, 2.0}, {1, 0, 1.0}, {1, 1, 2.0}};
  EXPECT_FALSE(factors.compute({2, 2, same_rows}));
  const std::vector<Triplet> regular{{0, 0, 1.0}, {1, 1, 2.0}};
  EXPECT_TRUE(factors.compute({2, 2, regular}));
  EXPECT_TRUE(factors.is_factorised());
}

TEST(SparseLu, KnowsSmallPivots) {
  const std::vector<Triplet> entries{{0, 0, 1.0}, {1, 0, 1.0}, {0, 1, 1.0}, {1, 1, 1.0 + 1e-9}, {2, 2, 1e-9}};
  const SparseColumns a(3, 3, entries);
  const SparseLu factors(a);
  ASSERT_TRUE(factors.is_factorised());
  const std::vector<double> ones{1.0, 1.0, 1.0}, own{1.0, 1.0, 1e-9}, least{1.0, 1e-9, 1e-9};
  EXPECT_TRUE(factors.has_small_pivot(ones, 1e-6));
  EXPECT_TRUE(factors.has_small_pivot(own, 1e-6));
  EXPECT_FALSE(factors.has_small_pivot(ones, 1e-12));
}

TEST(SparseLuOf, SolvesComplexSystems) {
  using Complex = std::complex<double>;
  std::mt19937 random(5);
  const Index n = 25;
  const SparseColumns a = random_square(random, n);
  std::vector<Complex> values(a.values().begin(), a.values().end());
  const Complex turn(0.6, 0.8);
  for (Complex& value : values) value *= turn;
  SparseLuOf<Complex> factors;
  factors.analyse(a.start(), a.inner());
  ASSERT_TRUE(factors.factorise(values));
  const Vector b = random_matrix(random, n, 1), x = Lu(a.dense()).solve(b);
  const std::vector<Complex> right(b.begin(), b.end());
  std::vector<Complex> solution(right.size());
  factors.solve(right, solution);
  for (Index i = 0; i < n; ++i) EXPECT_LT(std::abs(turn * solution[static_cast<std::size_t>(i)] - x[i]), 1e-12);
}

TEST(ComplexLu, SolvesShiftedSystems) {
  std::mt19937 random(6);
  ComplexLu factors;
  for (const Index n : {1, 3, 20}) {
    const Matrix a = random_matrix(random, n, n), b = random_matrix(random, n, 2);
    const std::complex<double> shift(0.7, 2.0);
    factors.compute_shifted(a, shift);
    Matrix x(n, 2);
    factors.solve(b.col(0), b.col(1), x.col(0), x.col(1));
    const Matrix real = shift.real() * x.col(0) - shift.imag() * x.col(1) - a * x.col(0);
    const Matrix imaginary = shift.real() * x.col(1) + shift.imag() * x.col(0) - a * x.col(1);
    EXPECT_LE(distance(real, b.col(0)), 1e-12) << n;
    EXPECT_LE(distance(imaginary, b.col(1)), 1e-12) << n;
  }
}

TEST(DependentColumns, LeaveABasis) {
  std::mt19937 random(7);
  const Matrix dense = random_of_rank(random, 8, 6, 4);
  std::vector<Triplet> entries;
  for (Index j = 0; j < 6; ++j) {
    for (Index i = 0; i < 8; ++i) entries.push_back({i, j, dense(i, j)});
  }
  const auto dependent = dependent_columns({8, 6, entries}, 1e-10);
  ASSERT_EQ(dependent.size(), 2U);
  std::vector<Index> others;
  for (Index j = 0; j < 6; ++j) {
    if (std::find(dependent.begin(), dependent.end(), j) == dependent.end()) others.push_back(j);
  }
  EXPECT_EQ(PivotedQr(dense.selected_cols(others)).rank(), 4);
  EXPECT_TRUE(dependent_columns(random_square(random, 12), 1e-10).empty());
}

/// The tip of an arrow comes last: before it, it would fill all of the matrix.
TEST(NullSpace, IsTakenToZero) {
  std::mt19937 random(7);
  auto entries = random_entries(random, 12, 6);
  // Columns 6 to 8 are combinations of the others.
  const std::size_t own = entries.size();
  for (std::size_t e = 0; e < own; ++e) {
    const auto [row, column, value] = entries[e];
    if (column < 2) entries.push_back({row, 6, 2.0 * value});
    if (column == 2) entries.push_back({row, 7, -value});
    if (column == 3) entries.push_back({row, 8, value});
    if (column == 5) entries.push_back({row, 8, 0.5 * value});
  }
  const SparseColumns a(12, 9, entries);
  const NullSpace null = null_space(a, 1e-10);
  ASSERT_EQ(null.dependent.size(), 3U);
  EXPECT_LT((a.dense() * null.vectors.dense()).max_abs(), 1e-13);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(null.vectors(null.dependent[j], static_cast<Index>(k)), j == k ? 1.0 : 0.0);
    }
  }
}

TEST(NullSpace, OfNothingHasAllUnitVectors) {
  const NullSpace null = null_space(SparseColumns(1, 3), 1e-10);
  EXPECT_EQ(null.dependent.size(), 3U);
  EXPECT_EQ(null.vectors.dense().sum_abs(), 3.0);
}

TEST(OrderOfLeastDegree, LeavesTheTipOfAnArrowToTheEnd) {
  const int n = 30;
  std::vector<int> start{0}, rows;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if (i == j || i == 0 || j == 0) rows.push_back(i);
    }
    start.push_back(static_cast<int>(rows.size()));
  }
  auto order = order_of_least_degree(n, start, rows);
  ASSERT_EQ(order.size(), 30U);
  // With one other left it does not matter.
  EXPECT_GE(std::find(order.begin(), order.end(), 0U) - order.begin(), n - 2);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace saltus::linalg
