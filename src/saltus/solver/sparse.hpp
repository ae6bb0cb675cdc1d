// Values on a pattern as sparse matrices.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "saltus/mpcc/problem.hpp"

namespace saltus::solver {

/// Makes a sparse matrix, in which entries of the same place add up; entries that are zero stay.
template <int Order = Eigen::ColMajor>
[[nodiscard]] Eigen::SparseMatrix<double, Order> sparse(const mpcc::Pattern& pattern, mpcc::ConstVectorView values,
                                                        int rows, int columns) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(pattern.row.size());
  for (std::size_t e = 0; e < pattern.row.size(); ++e) {
    entries.emplace_back(pattern.row[e], pattern.column[e], values[static_cast<Eigen::Index>(e)]);
  }
  Eigen::SparseMatrix<double, Order> matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Returns dc/dw at w, rows() x variables().
[[nodiscard]] inline RowMatrix jacobian_matrix(mpcc::Problem& problem, mpcc::ConstVectorView w) {
  Eigen::VectorXd values(problem.jacobian_pattern().entries());
  problem.jacobian(w, values);
  return sparse<Eigen::RowMajor>(problem.jacobian_pattern(), values, problem.rows(), problem.variables());
}

}  // namespace saltus::solver
