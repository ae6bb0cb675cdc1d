#include "saltus/switching/table/independent_rows.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

using Chosen = std::vector<std::size_t>;

TEST(IndependentRows, EachSaysSomethingThatThoseBeforeItDoNot) {
  // x1 - x2, x2 - x3, x1 - x3, nothing, x3: the third is the sum of the first two.
  const linalg::Matrix gradients{{1, -1, 0}, {0, 1, -1}, {1, 0, -1}, {0, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(independent_rows(gradients), (Chosen{0, 1, 4}));
}

TEST(IndependentRows, DoNotDependOnUnits) {
  const linalg::Matrix gradients{{1e8, 0}, {1e-8, 0}, {1e-8, 1e-9}};
  EXPECT_EQ(independent_rows(gradients), (Chosen{0, 2}));
}

/// The second row leaves `part` of itself.
Chosen with_part(double part) { return independent_rows({{1, 1}, {1 + part, 1 - part}}); }

TEST(IndependentRows, ThoseThatNearlyAgreeDepend) {
  EXPECT_EQ(with_part(1.01 * dependent_part), (Chosen{0, 1}));
  EXPECT_EQ(with_part(0.99 * dependent_part), (Chosen{0}));
}

TEST(IndependentRows, TwoThatNearlyAgreeStillSpanTheirPlane) {
  // The third row is in it; directions of the plane are known to 1e-10, the rounding of the rows over 2e-6.
  const linalg::Matrix gradients{{1, 1, 1}, {1 + 2e-6, 1 - 2e-6, 1}, {0.3, 0.7, 0.5}};
  EXPECT_EQ(independent_rows(gradients), (Chosen{0, 1}));
}

}  // namespace
}  // namespace saltus::switching
