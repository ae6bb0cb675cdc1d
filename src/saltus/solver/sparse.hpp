// Values on a pattern as sparse matrices.
#pragma once

#include <vector>

#include "saltus/linalg/sparse.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::solver {

/// Makes a sparse matrix, in which entries of the same place add up; entries that are zero stay.
template <linalg::Major major>
[[nodiscard]] linalg::Sparse<major> sparse(const mpcc::Pattern& pattern, mpcc::ConstVectorView values, int rows,
                                           int columns) {
  std::vector<linalg::Triplet> entries;
  entries.reserve(pattern.row.size());
  for (std::size_t e = 0; e < pattern.row.size(); ++e) {
    entries.push_back({pattern.row[e], pattern.column[e], values[static_cast<linalg::Index>(e)]});
  }
  return {rows, columns, entries};
}

using RowMatrix = linalg::SparseRows;

/// Returns dc/dw at w, rows() x variables().
[[nodiscard]] inline RowMatrix jacobian_matrix(mpcc::Problem& problem, mpcc::ConstVectorView w) {
  linalg::Vector values(problem.jacobian_pattern().entries());
  problem.jacobian(w, values);
  return sparse<linalg::Major::rows>(problem.jacobian_pattern(), values, problem.rows(), problem.variables());
}

}  // namespace saltus::solver
