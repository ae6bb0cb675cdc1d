#include <limits>

#include <gtest/gtest.h>

#include "saltus/foreign/row_ranges_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

TEST(RowRanges, RowsOfOneVariableAreBounds) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  const SX w = SX::sym("w", 3);
  // 2 w0 - 1 >= 3, -w1 >= -5, w0 + w1 <= 1, w2^2 <= 4; the last has no bounds, as the side of a pair.
  const SX rows = SX::vertcat({2 * w(0) - 1, -w(1), w(0) + w(1), w(2) * w(2), w(2) - 7});
  const mpcc::Bounds free{linalg::Vector::constant(3, -unlimited), linalg::Vector::constant(3, unlimited)};
  const mpcc::Bounds of_rows{linalg::Vector{3.0, -5.0, -unlimited, -unlimited},
                             linalg::Vector{unlimited, unlimited, 1.0, 4.0}};
  const SX jacobian = SX::jacobian(rows, w);
  const auto bounds = with_rows_of_one_variable(w, rows, jacobian, free, of_rows);
  EXPECT_EQ(bounds.lower[0], 2.0);
  EXPECT_EQ(bounds.upper[0], unlimited);
  EXPECT_EQ(bounds.lower[1], -unlimited);
  EXPECT_EQ(bounds.upper[1], 5.0);
  EXPECT_EQ(bounds.lower[2], -unlimited);
  EXPECT_EQ(bounds.upper[2], unlimited);
  EXPECT_EQ(ranges_of(w, rows, jacobian, bounds).lower[0], 3.0);
}

}  // namespace
}  // namespace saltus::foreign
