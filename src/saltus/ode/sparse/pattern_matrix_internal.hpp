// A sparse matrix with the entries of a pattern.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::ode {

/// Returns a matrix whose entries are all 1, in the order of the pattern.
template <class Scalar>
Eigen::SparseMatrix<Scalar> matrix_of(const JacobianPattern& pattern) {
  const auto n = static_cast<Eigen::Index>(pattern.columns());
  std::vector<Eigen::Triplet<Scalar>> triplets;
  for (std::size_t column = 0; column < pattern.columns(); ++column) {
    for (std::size_t k = pattern.start[column]; k < pattern.start[column + 1]; ++k) {
      triplets.emplace_back(static_cast<int>(pattern.row[k]), static_cast<int>(column), Scalar(1.0));
    }
  }
  Eigen::SparseMatrix<Scalar> matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace saltus::ode
