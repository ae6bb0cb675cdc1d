// Matrices with random entries, and products of them by three loops.
#pragma once

#include <random>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

/// Returns entries in [-1, 1].
inline Matrix random_matrix(std::mt19937& random, Index rows, Index columns) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Matrix matrix(rows, columns);
  for (double& value : matrix) value = entry(random);
  return matrix;
}

/// Returns a matrix of this rank: a product of two random ones.
inline Matrix random_of_rank(std::mt19937& random, Index rows, Index columns, Index rank) {
  return random_matrix(random, rows, rank) * random_matrix(random, rank, columns);
}

inline Matrix product_by_loops(ConstView a, ConstView b) {
  Matrix product = Matrix::zero(a.rows(), b.cols());
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index j = 0; j < b.cols(); ++j) {
      for (Index k = 0; k < a.cols(); ++k) product(i, j) += a(i, k) * b(k, j);
    }
  }
  return product;
}

/// Returns the largest difference of entries.
inline double distance(ConstView a, ConstView b) { return (a - b).max_abs(); }

}  // namespace saltus::linalg
