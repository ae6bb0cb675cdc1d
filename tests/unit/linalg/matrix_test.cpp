// Matrices and vectors that own their memory: moves, shapes, sums and products.
#include "saltus/linalg/matrix.hpp"

#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "random_matrices.hpp"

namespace saltus::linalg {
namespace {

/// Below and above what lies inside of the object.
const std::vector<Index> sizes{0, 1, 4, 16, 17, 40};

TEST(Matrix, IsCopied) {
  std::mt19937 random(1);
  for (const Index size : sizes) {
    Matrix a = random_matrix(random, size, 2);
    const Matrix before = a;
    Matrix copy(a);
    if (size > 0) a(0, 0) = 5.0;
    EXPECT_TRUE(copy == before);
    EXPECT_EQ(a == before, size == 0);
    copy = a;
    EXPECT_TRUE(copy == a);
    const Matrix& self = copy;
    copy = self;
    EXPECT_TRUE(copy == a);
  }
}

TEST(Matrix, IsMovedBetweenAllSizes) {
  std::mt19937 random(2);
  for (const Index from : sizes) {
    for (const Index to : sizes) {
      Matrix a = random_matrix(random, from, 1);
      const Matrix before = a;
      Matrix b = random_matrix(random, to, 1);
      b = std::move(a);
      EXPECT_TRUE(b == before);
      // What was moved from is empty and can be used.
      EXPECT_EQ(a.size(), 0);  // NOLINT(bugprone-use-after-move)
      a = random_matrix(random, to, 1);
      EXPECT_EQ(a.size(), to);
      const Matrix other = a;
      a.swap(b);
      EXPECT_TRUE(a == before);
      EXPECT_TRUE(b == other);
      const Matrix made(std::move(b));
      EXPECT_TRUE(made == other);
    }
  }
}

TEST(Matrix, LargeOnesChangeHands) {
  Matrix a(10, 10);
  const double* const memory = a.data();
  const Matrix b(std::move(a));
  EXPECT_EQ(b.data(), memory);
}

TEST(Matrix, KeepsItsMemoryWhereItShrinks) {
  Matrix a(10, 10);
  const double* const memory = a.data();
  a.resize(2, 3);
  a.resize(25, 4);
  EXPECT_EQ(a.data(), memory);
  a = Matrix::zero(3, 3) * 2.0;
  EXPECT_EQ(a.rows(), 3);
}

TEST(Matrix, KeepsEntriesWhereItIsAsked) {
  Matrix a{{1, 2}, {3, 4}};
  a.resize_and_keep(3, 1);
  EXPECT_EQ(a(1, 0), 3.0);
  a.resize_and_keep(6, 6);
  EXPECT_EQ(a(0, 0), 1.0);
  EXPECT_EQ(a(1, 0), 3.0);
  Vector b{1, 2, 3};
  b.resize_and_keep(30);
  EXPECT_EQ(b[2], 3.0);
  b.resize_and_keep(2);
  EXPECT_TRUE(b == Vector({1, 2}));
}

TEST(Matrix, TakesPartsOfItself) {
  std::mt19937 random(3);
  for (const Index n : {3, 4, 5, 9}) {
    const Matrix original = random_matrix(random, n, n);
    Matrix a = original;
    a = a.transpose();
    EXPECT_TRUE(a == original.transpose());
    a = original;
    a = a.block(1, 1, n - 1, n - 2);
    EXPECT_TRUE(a == original.block(1, 1, n - 1, n - 2));
    a = original;
    a = a.row(n - 1);
    EXPECT_TRUE(a == original.row(n - 1));
    Vector b = original.col(0);
    b = b.tail(n - 1);
    EXPECT_TRUE(b == original.col(0).tail(n - 1));
    Vector c = original.col(0);
    c = c.transpose();
    EXPECT_TRUE(c == original.col(0));
  }
}

TEST(Matrix, HasConstants) {
  EXPECT_TRUE(Matrix::identity(2, 3) == Matrix({{1, 0, 0}, {0, 1, 0}}));
  EXPECT_TRUE(Matrix::diagonal_of(Vector{1, 2}) == Matrix({{1, 0}, {0, 2}}));
  EXPECT_TRUE(Matrix::constant(1, 2, 3.0) == Matrix({{3, 3}}));
  EXPECT_TRUE(Matrix::zero(20, 20).is_zero());
  EXPECT_TRUE(Vector::unit(3, 1) == Vector({0, 1, 0}));
  EXPECT_TRUE(Vector::ones(2) == Vector({1, 1}));
  Matrix a;
  EXPECT_TRUE(a.empty());
  a.set_constant(2, 1, 4.0);
  EXPECT_TRUE(a == Vector({4, 4}));
  Vector b;
  EXPECT_EQ(b.cols(), 1);
  b.set_zero(20);
  EXPECT_TRUE(b.is_zero());
}

TEST(Vector, MakesColumnsOfRows) {
  const Matrix a{{1, 2, 3}, {4, 5, 6}};
  const Vector copied = a.row(1);
  EXPECT_TRUE(copied == Vector({4, 5, 6}));
  const Vector moved = a.row(0) * 2.0;
  EXPECT_TRUE(moved == Vector({2, 4, 6}));
  Vector assigned;
  assigned = a.row(1);
  EXPECT_TRUE(assigned == copied);
  assigned = a.row(0) + a.row(1);
  EXPECT_TRUE(assigned == Vector({5, 7, 9}));
  assigned = Matrix(0, 3).row_sums();
  EXPECT_EQ(assigned.size(), 0);
  EXPECT_EQ(assigned.cols(), 1);
  Vector taken = std::move(assigned);
  EXPECT_EQ(assigned.cols(), 1);  // NOLINT(bugprone-use-after-move)
}

TEST(Matrix, HasSums) {
  const Matrix a{{1, 2}, {3, 4}}, b{{10, 20}, {30, 40}};
  EXPECT_TRUE(a + b == Matrix({{11, 22}, {33, 44}}));
  EXPECT_TRUE(b - a == Matrix({{9, 18}, {27, 36}}));
  EXPECT_TRUE(-a == Matrix({{-1, -2}, {-3, -4}}));
  EXPECT_TRUE(2.0 * a == a * 2.0);
  EXPECT_TRUE(b / 10.0 == a);
  EXPECT_TRUE(a + a.transpose() == Matrix({{2, 5}, {5, 8}}));
  EXPECT_TRUE(plus_column(a, Vector{1, 10}) == Matrix({{2, 3}, {13, 14}}));
  EXPECT_TRUE(plus_row(a, Vector{1, 10}) == Matrix({{2, 12}, {4, 14}}));
  EXPECT_TRUE(scaled_rows(Vector{2, 3}, a) == Matrix({{2, 4}, {9, 12}}));
  EXPECT_TRUE(scaled_cols(a, Vector{2, 3}) == Matrix({{2, 6}, {6, 12}}));
  EXPECT_TRUE(joined({Vector{1, 2}, a.row(1), Vector()}) == Vector({1, 2, 3, 4}));
  EXPECT_FALSE(a == Vector({1, 2}));
}

TEST(Matrix, ProductsAreThoseOfThreeLoops) {
  std::mt19937 random(4);
  for (const Index n : {0, 1, 2, 5, 15, 16, 33}) {
    for (const Index k : {0, 1, 3, 16, 20}) {
      for (const Index m : {0, 1, 2, 17}) {
        const Matrix a = random_matrix(random, n, k), b = random_matrix(random, k, m);
        const Matrix product = product_by_loops(a, b);
        EXPECT_LE(distance(a * b, product), 1e-13);
        EXPECT_LE(distance(b.transpose() * a.transpose(), product.transpose()), 1e-13);
        const Matrix a_by_rows = a.transpose(), b_by_rows = b.transpose();
        EXPECT_LE(distance(a_by_rows.transpose() * b, product), 1e-13);
        EXPECT_LE(distance(a * b_by_rows.transpose(), product), 1e-13);
        Matrix larger = Matrix::zero(n + 2, m + 2);
        multiply(a, b, larger.block(1, 1, n, m));
        EXPECT_LE(distance(larger.block(1, 1, n, m), product), 1e-13);
        EXPECT_TRUE(larger.row(0).is_zero() && larger.col(m + 1).is_zero());
      }
    }
  }
}

TEST(Matrix, ProductsOfRowsAndColumns) {
  const Matrix a{{1, 2}, {3, 4}};
  const Vector b{10, 100};
  EXPECT_TRUE(a * b == Vector({210, 430}));
  EXPECT_TRUE(b.transpose() * a == Matrix({{310, 420}}));
  EXPECT_TRUE(a.row(0) * b == Matrix({{210}}));
  EXPECT_TRUE(b * a.row(0) == Matrix({{10, 20}, {100, 200}}));
  EXPECT_TRUE(b * b.transpose() == Matrix({{100, 1000}, {1000, 10000}}));
  // Of nothing summed up.
  EXPECT_TRUE(Matrix(2, 0) * Matrix(0, 3) == Matrix::zero(2, 3));
}

}  // namespace
}  // namespace saltus::linalg
