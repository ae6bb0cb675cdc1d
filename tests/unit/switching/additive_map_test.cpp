#include "saltus/switching/table/additive_map.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "saltus/switching/selections/selection_balances.hpp"

namespace saltus::switching {
namespace {

using linalg::Matrix;
using linalg::Vector;

TEST(AdditiveMap, FindsWhatEachSelectionAdds) {
  const Matrix effects{{1.0, -2.0, 0.0, 3.0, 0.5}, {0.0, 1e-8, 4.0, -1.0, 2.0}};
  const Vector constant{-1.0, 2.0};
  int values = 0;
  const auto map = additive_map(5, [&](const std::vector<double>& alpha, Vector& value) {
    ++values;
    value = constant + effects * linalg::ConstView(alpha);
  });
  ASSERT_TRUE(map);
  // Sums of five numbers up to 4.
  EXPECT_LE((map->effects - effects).max_abs(), 1e-14);
  EXPECT_EQ(map->constant, constant);
  EXPECT_EQ(values, 16);
}

/// The product of any two of six selections shows.
TEST(AdditiveMap, RefusesAnyProductOfTwo) {
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto map = additive_map(6, [&](const std::vector<double>& alpha, Vector& value) {
        value = Vector::constant(1, 1.0 + alpha[0] + 1e-6 * alpha[i] * alpha[j]);
      });
      EXPECT_FALSE(map) << i << ", " << j;
    }
  }
}

TEST(AdditiveMap, PassesOnWhatIsNotFinite) {
  const auto map = additive_map(2, [](const std::vector<double>& alpha, Vector& value) {
    value = Vector::constant(1, alpha[1] > 0.0 ? std::numeric_limits<double>::quiet_NaN() : 0.0);
  });
  ASSERT_TRUE(map);
  EXPECT_FALSE(map->effects.all_finite());
}

/// Functions 0 and 2 share selection 1, function 1 has its own two; selection 2 moves nothing but rounding.
TEST(SelectionBalances, AreFunctionsThatShareSelections) {
  const Matrix effects{{1.0, 2.0, 1e-17, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0, -1.0}, {0.0, -3.0, 0.0, 0.0, 0.0}};
  const auto found = balances_of(effects, Matrix::constant(3, 5, 1.0));
  ASSERT_EQ(found.all.size(), 2U);
  EXPECT_EQ(found.all[0].functions, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(found.all[0].rows, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found.all[1].functions, (std::vector<std::size_t>{1}));
  EXPECT_EQ(found.all[1].rows, (std::vector<std::size_t>{3, 4}));
  EXPECT_EQ(found.unused, (std::vector<std::size_t>{2}));
}

/// A function that joins two groups late brings all of them together.
TEST(SelectionBalances, AreJoinedByWhatComesLast) {
  Matrix effects = Matrix::zero(4, 3);
  effects(0, 0) = effects(2, 0) = 1.0;
  effects(1, 1) = effects(3, 1) = 1.0;
  effects(2, 2) = effects(3, 2) = 1.0;
  const auto found = balances_of(effects, Matrix::constant(4, 3, 1.0));
  ASSERT_EQ(found.all.size(), 1U);
  EXPECT_EQ(found.all[0].functions.size(), 4U);
  EXPECT_EQ(found.all[0].rows.size(), 3U);
}

}  // namespace
}  // namespace saltus::switching
