#include "saltus/event_integrator/mode/region_ties.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;

Matrix rows_of(const RegionBasis& basis, const Matrix& rows) {
  Matrix spanning(static_cast<Index>(basis.base.size()), rows.cols());
  for (std::size_t k = 0; k < basis.base.size(); ++k) spanning.row(static_cast<Index>(k)) = rows.row(basis.base[k]);
  return spanning;
}

}  // namespace

RegionBasis basis_of(const Matrix& rows) {
  Matrix rest = rows;
  for (Index i = 0; i < rest.rows(); ++i) {
    if (const double length = rest.row(i).norm(); length > 0.0) rest.row(i) /= length;
  }
  RegionBasis basis;
  while (basis.base.size() < static_cast<std::size_t>(std::min(rest.rows(), rest.cols()))) {
    const linalg::Vector norms = rest.row_norms();
    const Index best = norms.index_of_max();
    if (!(norms[best] > switching::dependent_part)) break;
    const Matrix direction = rest.row(best).normalized();
    rest -= (rest * direction.transpose()) * direction;
    basis.base.push_back(best);
  }
  std::sort(basis.base.begin(), basis.base.end());
  return basis;
}

RegionCoordinates coordinates_in(const RegionBasis& basis, const Matrix& rows) {
  const auto m = static_cast<Index>(basis.base.size());
  RegionCoordinates coordinates = RegionCoordinates::zero(rows.rows() + 1, m);
  if (m == 0) return coordinates;
  RegionCoordinates normal(m, m), right(m, rows.rows());
  for (Index k = 0; k < m; ++k) {
    const auto row = rows.row(basis.base[at(k)]);
    for (Index l = 0; l < m; ++l) normal(k, l) = row.dot(rows.row(basis.base[at(l)]));
    for (Index i = 0; i < rows.rows(); ++i) right(k, i) = row.dot(rows.row(i));
  }
  linalg::Cholesky(normal).solve_in_place(right);  // rows of a basis are independent
  coordinates.bottom_rows(rows.rows()) = right.transpose();
  for (Index k = 0; k < m; ++k) {  // exactly what they are
    coordinates.row(basis.base[at(k)] + 1).set_zero();
    coordinates(basis.base[at(k)] + 1, k) = 1.0;
  }
  return coordinates;
}

double remainder(const RegionBasis& basis, const Matrix& rows) {
  if (basis.base.empty()) return rows.size() > 0 ? 1.0 : 0.0;
  const Matrix rest = rows - coordinates_in(basis, rows).bottom_rows(rows.rows()) * rows_of(basis, rows);
  double largest = 0.0;
  for (Index i = 0; i < rows.rows(); ++i) {
    const double length = rows.row(i).norm();
    if (length > 0.0) largest = std::max(largest, rest.row(i).norm() / length);
  }
  return largest;
}

namespace {

/// The coefficients of an affine function and its rate in t; false if it is none.
bool affine_row(const evaluation::AffineRows& rows, int function, linalg::Matrix& matrix, Index place) {
  const auto j = at(function);
  matrix.row(place).set_zero();
  matrix(place, matrix.cols() - 1) = rows.rate[j];
  for (std::size_t k = rows.start[j]; k < rows.start[j + 1]; ++k) {
    matrix(place, static_cast<Index>(rows.column[k])) = rows.coefficient[k];
  }
  return std::isfinite(rows.offset[j]) && matrix.row(place).all_finite();
}

}  // namespace

std::vector<bool> constant_beside_held(const evaluation::ModelKernel& kernel, const ModeState& state,
                                       const evaluation::AffineRows& rows) {
  std::vector<bool> constant;
  if (state.sliding.empty()) return constant;
  const Index columns = kernel.states() + 1;
  Matrix held(static_cast<Index>(state.sliding.size()), columns), row(1, columns);
  Index count = 0;
  for (const int j : state.sliding) count += kernel.inner(j).empty() && affine_row(rows, j, held, count) ? 1 : 0;
  if (count == 0) return constant;
  held.resize_and_keep(count, columns);
  const RegionBasis basis = basis_of(held);
  const Matrix spanning = rows_of(basis, held);
  // The rows of a basis are independent to a millionth, so that coefficients of 16 digits leave ten of a combination.
  constexpr double rounding = 1e-10;
  for (const auto& group : kernel.region_groups()) {
    for (int j = group.first; j < group.first + group.count; ++j) {
      if (state.mode[at(j)] != -1 || !kernel.inner(j).empty() || !affine_row(rows, j, row, 0)) continue;
      const double length = row.norm();
      const linalg::Vector part = linalg::PivotedQr(spanning.transpose()).solve(row.transpose());
      if (!((row - part.transpose() * spanning).norm() <= rounding * length)) continue;
      constant.resize(state.mode.size(), false);
      constant[at(j)] = true;
    }
  }
  return constant;
}

}  // namespace saltus::event_integrator
