// Linear equations in expressions.
#include <array>
#include <limits>

#include <casadi/core/sx_elem.hpp>
#include <gtest/gtest.h>

#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

TEST(Eliminate, OfASymmetricMatrixOnlyTheUpperTriangleIsRead) {
  constexpr std::array<std::array<double, 3>, 3> a{{{4.0, 1.0, -2.0}, {1.0, 3.0, 0.5}, {-2.0, 0.5, 5.0}}};
  constexpr std::array<double, 3> b{1.0, -2.0, 0.25};
  SX whole(3, 3), upper(3, 3), right(3, 1);
  for (casadi_int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    right(i) = b[row];
    for (casadi_int j = 0; j < 3; ++j) {
      const double entry = a[row][static_cast<std::size_t>(j)];
      whole(i, j) = entry;
      upper(i, j) = j < i ? std::numeric_limits<double>::quiet_NaN() : entry;
    }
  }
  for (const SX& solution : {eliminate(whole, right, Symmetry::none), eliminate(upper, right, Symmetry::symmetric)}) {
    for (std::size_t row = 0; row < 3; ++row) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) sum += a[row][k] * static_cast<double>(solution.nonzeros()[k]);
      EXPECT_NEAR(sum, b[row], 1e-14);
    }
  }
}

}  // namespace
}  // namespace saltus::model
