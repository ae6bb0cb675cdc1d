// Eigenvalues and singular values of matrices where they are known.
#include "saltus/linalg/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "random_matrices.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::linalg {
namespace {

Matrix random_rotation(std::mt19937& random, Index n) {
  return PivotedQr(random_matrix(random, n, n)).times_q(Matrix::identity(n, n));
}

TEST(SingularValues, AreThoseOfAMatrixMadeOfThem) {
  std::mt19937 random(1);
  const Vector values{5.0, 2.0, 1e-3};
  const Matrix v = random_rotation(random, 3);
  const Matrix a = random_rotation(random, 4).left_cols(3) * Matrix::diagonal_of(values) * v.transpose();
  const auto found = singular_values(a);
  EXPECT_LT(distance(found.values, values), 1e-14);
  EXPECT_LT(distance((found.right.transpose() * v).abs(), Matrix::identity(3, 3)), 1e-12);
  EXPECT_NEAR(spectral_norm(a), 5.0, 1e-14);
  EXPECT_EQ(spectral_norm(Matrix()), 0.0);
  // All of V where there are more columns than rows.
  const auto wide = singular_values(a.transpose());
  ASSERT_EQ(wide.right.cols(), 4);
  EXPECT_LT((a.transpose() * wide.right.col(3)).max_abs(), 1e-14);
}

TEST(SymmetricEigenvalues, AreThoseOfAMatrixMadeOfThem) {
  std::mt19937 random(2);
  const Vector values{-3.0, 0.0, 1.0, 7.0};
  const Matrix q = random_rotation(random, 4);
  EXPECT_LT(distance(symmetric_eigenvalues(q * Matrix::diagonal_of(values) * q.transpose()), values), 1e-13);
}

/// diag(1, 2, 3) v = lambda diag(1, 4, 0) v: one of them is infinite.
TEST(PencilEigenvalues, MayBeInfinite) {
  const auto values = pencil_eigenvalues(Matrix::diagonal_of(Vector{1, 2, 3}), Matrix::diagonal_of(Vector{1, 4, 0}));
  ASSERT_TRUE(values.has_value());
  ASSERT_EQ(values->size(), 3U);
  std::vector<double> finite;
  for (const auto& [alpha, beta] : *values) {
    if (std::abs(beta) > 1e-14 * std::abs(alpha)) finite.push_back(alpha.real() / beta);
  }
  std::sort(finite.begin(), finite.end());
  ASSERT_EQ(finite.size(), 2U);
  EXPECT_NEAR(finite[0], 0.5, 1e-14);
  EXPECT_NEAR(finite[1], 1.0, 1e-14);
}

/// Those of B^-1 A with A = B M and M a rotation beside a number, in another basis.
TEST(PencilEigenvalues, MayBePairs) {
  std::mt19937 random(4);
  const double angle = 0.3, real = std::cos(angle), imaginary = std::sin(angle);
  const Matrix basis = random_matrix(random, 3, 3), b = random_matrix(random, 3, 3);
  const Matrix m = basis * Matrix{{real, -imaginary, 0}, {imaginary, real, 0}, {0, 0, 4}} * inverse(basis);
  const auto values = pencil_eigenvalues(b * m, b).value();
  ASSERT_EQ(values.size(), 3U);
  double sum_of_pair = 0.0, alone = 0.0;
  for (const auto& [alpha, beta] : values) {
    const auto value = alpha / beta;
    if (alpha.imag() == 0.0) {
      alone = value.real();
      continue;
    }
    EXPECT_NEAR(value.real(), real, 1e-11);
    EXPECT_NEAR(std::abs(value.imag()), imaginary, 1e-11);
    sum_of_pair += value.imag();
  }
  EXPECT_NEAR(alone, 4.0, 1e-11);
  EXPECT_NEAR(sum_of_pair, 0.0, 1e-14);
}

}  // namespace
}  // namespace saltus::linalg
