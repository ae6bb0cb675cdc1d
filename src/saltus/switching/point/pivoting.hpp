// A linear complementarity problem by complementary pivots.
#pragma once

#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Returns z >= 0 with 0 <= w + W z complementary to z, by Lemke's method with a shift of w against cycles
/// [cottle1992]; nothing where it ends on a ray, which is where there is none if W is copositive-plus, or a P-matrix;
/// else there may be solutions that it does not find.
/// @param basic  by row, on return: whether z is basic (its row of w + W z is held at 0); empty: not asked for
/// Cost: n^2 operations a pivot, 2 n pivots or a few more.
[[nodiscard]] std::optional<linalg::Vector> complementary_pivots(const linalg::Matrix& effects,
                                                                 const linalg::Vector& constant,
                                                                 std::vector<bool>* basic = nullptr);

}  // namespace saltus::switching
