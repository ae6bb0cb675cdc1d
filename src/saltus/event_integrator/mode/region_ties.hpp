// Which differences of the indicators of regions that meet depend on each other, from their gradients.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Takes some rows into a matrix that is used again.
template <class Indices>
void take_rows(linalg::ConstView from, const Indices& rows, linalg::Matrix& result) {
  result.resize(static_cast<linalg::Index>(rows.size()), from.cols());
  linalg::Index k = 0;
  for (const auto row : rows) result.row(k++) = from.row(static_cast<linalg::Index>(row));
}

/// Holds, of n - 1 rows grad psi_i, psi_i = g_r - g_i, those that are independent, and the others by these.
struct RegionBasis {
  std::vector<linalg::Index> base;  ///< rows, ascending
  [[nodiscard]] bool spans_all(linalg::Index rows) const { return static_cast<linalg::Index>(base.size()) == rows; }
};

/// Finds a basis of rows. Rows that depend on others to switching::dependent_part, as for surfaces that touch, are not
/// in the basis.
[[nodiscard]] RegionBasis basis_of(const linalg::Matrix& rows);

/// Of up to 12 regions, which is what meets.
using RegionCoordinates = linalg::Matrix;

/// Returns the coordinates of the reference (0) and of all rows in the basis: n x m, grad psi_i = sum_k y_ik grad
/// psi_base(k). Allocates nothing where these are at most 16 numbers.
[[nodiscard]] RegionCoordinates coordinates_in(const RegionBasis& basis, const linalg::Matrix& rows);

/// Returns the largest part of a row that the basis does not span, relative to the row.
[[nodiscard]] double remainder(const RegionBasis& basis, const linalg::Matrix& rows);

/// Finds the regions of groups that are not active, but whose psi is a combination of those that are held, of the same
/// functions of (t, x): psi_i = sum_k c_k psi_k + const. While these are held it is constant, and its sign, where that
/// constant is 0, a rounding: nothing to watch.
/// @param rows  psi of all functions, NaN where one is not affine
/// @return by switching function; empty if there is none
/// Cost: that of the rows as a dense matrix, in modes that hold regions only.
[[nodiscard]] std::vector<bool> constant_beside_held(const evaluation::ModelKernel& kernel, const ModeState& state,
                                                     const evaluation::AffineRows& rows);

}  // namespace saltus::event_integrator
