// Scales of rows and columns by which the entries of a matrix become comparable.
#pragma once

#include <span>

namespace saltus::linalg::fronts {

/// Scales the entries of a symmetric matrix (one triangle) to S A S, whose largest entry in each row is about 1. S has
/// powers of 2: no digit is lost. Rows without entries have 1. Cost: a few visits to each entry.
/// @param work  as large as `scale`
void equilibrate(std::span<const int> row, std::span<const int> column, std::span<double> values,
                 std::span<double> scale, std::span<double> work);

}  // namespace saltus::linalg::fronts
