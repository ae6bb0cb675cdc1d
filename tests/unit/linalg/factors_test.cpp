// Factorisations of dense matrices against what they are to solve.
#include "saltus/linalg/factors.hpp"

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "random_matrices.hpp"

namespace saltus::linalg {
namespace {

/// On both sides of where blocks begin.
const std::vector<Index> orders{1, 2, 3, 5, 12, 47, 48, 60};

/// |A x - b| over |A| |x|.
double residual(ConstView a, ConstView x, ConstView b) { return (a * x - b).norm() / (a.norm() * x.norm()); }

Matrix random_positive(std::mt19937& random, Index n) {
  const Matrix root = random_matrix(random, n, n);
  return root * root.transpose() + 0.1 * Matrix::identity(n, n);
}

TEST(Lu, Solves) {
  std::mt19937 random(1);
  Lu kept;
  for (const Index n : orders) {
    const Matrix a = random_matrix(random, n, n), b = random_matrix(random, n, 3);
    kept.compute(a);
    const Matrix x = kept.solve(b);
    EXPECT_LT(residual(a, x, b), 1e-14) << n;
    Matrix in_place = b.transpose();
    kept.solve_in_place(in_place.transpose());
    EXPECT_LE(distance(in_place.transpose(), x), 1e-15 * x.norm()) << n;
    const Lu copy = kept;
    EXPECT_TRUE(copy.solve(b) == x);
    EXPECT_LT(distance(inverse(a) * a, Matrix::identity(n, n)), 1e-9) << n;
    // Of a view with steps.
    EXPECT_LT(residual(a.transpose(), Lu(a.transpose()).solve(b), b), 1e-14) << n;
  }
}

TEST(Lu, SolvesInPlaceWhereverTheRightSideLies) {
  std::mt19937 random(11);
  for (const Index n : orders) {
    const Matrix a = random_matrix(random, n, n);
    const Lu factors(a);
    Matrix rows = random_matrix(random, 3, n);
    const Matrix before = rows;
    factors.solve_in_place(rows.middle_rows(1, 1).transpose());
    EXPECT_TRUE(rows.row(1).transpose() == factors.solve(before.row(1).transpose()));
    EXPECT_TRUE(rows.row(0) == before.row(0));
    EXPECT_TRUE(rows.row(2) == before.row(2));
  }
}

TEST(Lu, HasDeterminants) {
  std::mt19937 random(2);
  EXPECT_EQ(determinant(Matrix{{0, 1}, {1, 0}}), -1.0);
  EXPECT_EQ(determinant(Matrix{{1, 2}, {2, 4}}), 0.0);
  EXPECT_EQ(determinant(Matrix(0, 0)), 1.0);
  for (const Index n : orders) {
    const Matrix a = random_matrix(random, n, n), b = random_matrix(random, n, n);
    const double expected = determinant(a) * determinant(b);
    EXPECT_NEAR(determinant(a * b), expected, 1e-9 * std::abs(expected)) << n;
    // Two rows in the other order.
    if (n == 1) continue;
    Matrix swapped = a;
    swapped.row(0) = a.row(n - 1);
    swapped.row(n - 1) = a.row(0);
    EXPECT_NEAR(determinant(swapped), -determinant(a), 1e-11 * std::abs(determinant(a))) << n;
  }
}

TEST(Lu, SingularMatricesHaveNoFiniteSolution) {
  for (const Index n : {1, 2, 4, 50}) {
    EXPECT_FALSE(Lu(Matrix::zero(n, n)).solve(Vector::ones(n)).all_finite()) << n;
    Matrix twice = Matrix::identity(n, n);
    twice.row(n - 1) = twice.row(0);
    if (n > 1) {
      EXPECT_FALSE(Lu(twice).solve(Vector::unit(n, 0)).all_finite()) << n;
    }
  }
}

TEST(FullLu, KnowsRankAndKernel) {
  std::mt19937 random(3);
  for (const Index rank : {1, 2, 4}) {
    const Matrix a = random_of_rank(random, 5, 6, rank);
    FullLu factors;
    factors.set_threshold(1e-10);
    factors.compute(a);
    EXPECT_EQ(factors.rank(), rank);
    EXPECT_EQ(factors.dimension_of_kernel(), 6 - rank);
    const Matrix kernel = factors.kernel();
    ASSERT_EQ(kernel.cols(), 6 - rank);
    EXPECT_LT((a * kernel).max_abs(), 1e-12 * kernel.max_abs());
    EXPECT_EQ(PivotedQr(kernel).rank(), 6 - rank);
    EXPECT_FALSE(factors.is_invertible());
    const Vector b = a * random_matrix(random, 6, 1);
    EXPECT_LT(distance(a * factors.solve(b), b), 1e-12);
  }
}

TEST(FullLu, InvertsWhatHasFullRank) {
  std::mt19937 random(4);
  const Matrix a = random_matrix(random, 7, 7), b = random_matrix(random, 7, 2);
  const FullLu factors(a);
  EXPECT_TRUE(factors.is_invertible());
  EXPECT_EQ(factors.dimension_of_kernel(), 0);
  EXPECT_TRUE(factors.kernel().is_zero());
  EXPECT_LT(residual(a, factors.solve(b), b), 1e-14);
  EXPECT_LT(distance(factors.inverse() * a, Matrix::identity(7, 7)), 1e-11);
  EXPECT_EQ(FullLu(Matrix{{0, 3}, {-5, 0}}).last_pivot(), 3.0);
  EXPECT_EQ(FullLu(Matrix{{1, 1}, {1, 1}}).last_pivot(), 0.0);
}

/// Whether x makes |A x - b| least: what is left is normal to the columns of A.
void expect_least_squares(ConstView a, ConstView x, ConstView b) {
  EXPECT_LT((a.transpose() * (a * x - b)).max_abs(), 1e-11);
}

TEST(PivotedQr, SolvesInTheSenseOfLeastSquares) {
  std::mt19937 random(5);
  for (const Index n : {1, 3, 6}) {
    const Matrix a = random_matrix(random, 9, n), b = random_matrix(random, 9, 2);
    const PivotedQr factors(a);
    EXPECT_EQ(factors.rank(), n);
    expect_least_squares(a, factors.solve(b), b);
    // Q is orthogonal, and its first columns span those of A.
    const Matrix q = factors.times_q(Matrix::identity(9, 9));
    EXPECT_LT(distance(q.transpose() * q, Matrix::identity(9, 9)), 1e-14);
    EXPECT_LT((q.right_cols(9 - n).transpose() * a).max_abs(), 1e-14);
    const auto order = factors.column_order();
    EXPECT_EQ(order.front(), a.col_norms().index_of_max());
    EXPECT_EQ(std::set<Index>(order.begin(), order.end()).size(), static_cast<std::size_t>(n));
  }
}

TEST(PivotedQr, FindsTheRankToItsThreshold) {
  std::mt19937 random(6);
  EXPECT_EQ(PivotedQr(random_of_rank(random, 8, 6, 3)).rank(), 3);
  const Matrix nearly{{1, 1}, {1, 1 + 1e-6}};
  EXPECT_EQ(PivotedQr(nearly).rank(), 2);
  PivotedQr factors;
  factors.set_threshold(1e-5);
  factors.compute(nearly);
  EXPECT_EQ(factors.rank(), 1);
}

TEST(OrthogonalFactors, GiveTheLeastOfAllLeastSquares) {
  std::mt19937 random(7);
  for (const Index rank : {1, 3, 5}) {
    const Matrix a = random_of_rank(random, 6, 8, rank), b = random_matrix(random, 6, 2);
    const OrthogonalFactors factors(a);
    EXPECT_EQ(factors.rank(), rank);
    const Matrix x = factors.solve(b);
    expect_least_squares(a, x, b);
    const Matrix basis = factors.null_space();
    ASSERT_EQ(basis.cols(), 8 - rank);
    EXPECT_LT((a * basis).max_abs(), 1e-13);
    EXPECT_LT(distance(basis.transpose() * basis, Matrix::identity(8 - rank, 8 - rank)), 1e-13);
    EXPECT_LT((basis.transpose() * x).max_abs(), 1e-12);  // the least one has no part that A does not see
    EXPECT_LT(distance(factors.pseudo_inverse() * b, x), 1e-11);
    EXPECT_LT(distance(least_squares(a, b), x), 1e-13);
  }
  EXPECT_EQ(OrthogonalFactors(random_matrix(random, 4, 4)).null_space().cols(), 0);
}

TEST(Cholesky, SolvesPositiveMatricesOnly) {
  std::mt19937 random(8);
  for (const Index n : orders) {
    const Matrix a = random_positive(random, n), b = random_matrix(random, n, 2);
    const Cholesky factors(a);
    ASSERT_TRUE(factors.is_positive());
    const Matrix x = factors.solve(b);
    EXPECT_LT(residual(a, x, b), 1e-14) << n;
    Matrix in_place = b;
    factors.solve_in_place(in_place);
    EXPECT_TRUE(in_place == x);
  }
  EXPECT_FALSE(Cholesky(Matrix{{1, 2}, {2, 1}}).is_positive());
}

TEST(Ldl, SolvesSemiDefiniteMatrices) {
  std::mt19937 random(9);
  for (const Index n : orders) {
    const Matrix a = random_positive(random, n), b = random_matrix(random, n, 2);
    const Ldl factors(a);
    ASSERT_TRUE(factors.is_factorised());
    EXPECT_TRUE(factors.is_positive());
    EXPECT_GT(factors.pivots().min(), 0.0);
    const Matrix x = factors.solve(b);
    EXPECT_LT(residual(a, x, b), 1e-14) << n;
    Matrix in_place = b;
    factors.solve_in_place(in_place);
    EXPECT_LT(distance(in_place, x), 1e-15 * x.norm());
  }
  const Matrix half = random_matrix(random, 6, 3);
  const Matrix semi = half * half.transpose();
  const Vector b = semi * random_matrix(random, 6, 1);
  EXPECT_LT(distance(semi * Ldl(semi).solve(b), b), 1e-12);
  EXPECT_FALSE(Ldl(Matrix{{1, 2}, {2, 1}}).is_positive());
}

TEST(Factors, AreCopiedAndMovedWithTheirOwners) {
  std::mt19937 random(10);
  const Matrix a = random_positive(random, 5), b = random_matrix(random, 5, 1);
  Cholesky first(a);
  const Matrix x = first.solve(b);
  const Cholesky copy = first;
  first.compute(Matrix::identity(5, 5));
  EXPECT_TRUE(copy.solve(b) == x);
  EXPECT_TRUE(first.solve(b) == b);
  Cholesky moved = std::move(first);
  EXPECT_TRUE(moved.solve(b) == b);
  moved = copy;
  EXPECT_TRUE(moved.solve(b) == x);
}

TEST(Factors, BeginAnewBehindAMove) {
  Cholesky first(Matrix::identity(2, 2));
  const Cholesky moved = std::move(first);
  Cholesky copy = first;  // NOLINT(bugprone-use-after-move)
  const Matrix a{{4, 0}, {0, 1}};
  copy.compute(a);
  first.compute(a);
  EXPECT_TRUE(copy.solve(Vector{4, 1}) == Vector({1, 1}));
  EXPECT_TRUE(first.solve(Vector{4, 1}) == Vector({1, 1}));
  copy = moved;
  EXPECT_TRUE(copy.solve(Vector{4, 1}) == Vector({4, 1}));
}

}  // namespace
}  // namespace saltus::linalg
