// Views of memory with steps: what they read, write and sum up.
#include "saltus/linalg/views.hpp"

#include <array>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "random_matrices.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// 2 x 3 by columns in memory of somebody else: 1 3 5; 2 4 6.
struct Viewed {
  std::vector<double> memory{1, 2, 3, 4, 5, 6};
  View view{memory.data(), 2, 3};
};

TEST(View, ShowsColumnsOneBehindTheOther) {
  const Viewed own;
  const ConstView a = own.view;
  EXPECT_EQ(a(1, 2), 6.0);
  EXPECT_TRUE(a == Matrix({{1, 3, 5}, {2, 4, 6}}));
  EXPECT_TRUE(a.is_contiguous());
  EXPECT_FALSE(a.row(0).is_contiguous());
  EXPECT_TRUE(a.middle_cols(1, 2).is_contiguous());
}

TEST(View, PartsAndTransposesShowTheSameMemory) {
  Viewed own;
  View a = own.view;
  EXPECT_TRUE(a.transpose() == Matrix({{1, 2}, {3, 4}, {5, 6}}));
  EXPECT_TRUE(a.row(1) == Matrix({{2, 4, 6}}));
  EXPECT_TRUE(a.row(1).transpose() == Vector({2, 4, 6}));
  EXPECT_TRUE(a.block(0, 1, 2, 2) == Matrix({{3, 5}, {4, 6}}));
  EXPECT_TRUE(a.left_cols(1) == Vector({1, 2}));
  EXPECT_TRUE(a.right_cols(2).bottom_rows(1) == Matrix({{4, 6}}));
  EXPECT_TRUE(a.transpose().top_rows(2) == Matrix({{1, 2}, {3, 4}}));
  EXPECT_TRUE(a.diagonal() == Vector({1, 4}));
  EXPECT_TRUE(a.row(1).tail(2) == Matrix({{4, 6}}));
  EXPECT_TRUE(a.col(2).head(1) == Vector({5}));
  a.transpose()(2, 1) = 60.0;
  EXPECT_EQ(own.memory[5], 60.0);
  a.transpose().row(0) = {10.0, 20.0};
  EXPECT_EQ(own.memory[1], 20.0);
  a.diagonal() = {7.0, 8.0};
  EXPECT_TRUE(a == Matrix({{7, 3, 5}, {20, 8, 60}}));
}

TEST(View, StepsPassOverWhatIsBetween) {
  std::vector<double> memory(12, 0.0);
  View odd(memory.data() + 1, 2, 2, 2, 6);
  odd = Matrix{{1, 2}, {3, 4}};
  EXPECT_EQ(memory, (std::vector<double>{0, 1, 0, 3, 0, 0, 0, 2, 0, 4, 0, 0}));
  odd.col(1) *= 2.0;
  EXPECT_EQ(odd.sum(), 16.0);
  EXPECT_EQ(odd.row(1)[1], 8.0);
}

TEST(View, AssignmentCopiesIntoItsMemory) {
  Viewed own;
  View a = own.view;
  const std::vector<double> row{7, 8, 9};
  a.row(0) = ConstView(row);  // a column into a row
  EXPECT_TRUE(a == Matrix({{7, 8, 9}, {2, 4, 6}}));
  a.row(1) += ConstView(row);
  EXPECT_TRUE(a.row(1) == Matrix({{9, 12, 15}}));
  a.col(0) = a.col(2);
  EXPECT_TRUE(a == Matrix({{9, 8, 9}, {15, 12, 15}}));
  // Another view of the same shape, not the view itself.
  Viewed other;
  a = other.view;
  EXPECT_EQ(own.memory, other.memory);
  EXPECT_NE(a.data(), other.view.data());
}

TEST(View, PartsThatOverlapCanBeMovedForward) {
  std::vector<double> memory{1, 2, 3, 4, 5};
  View a(memory);
  a.head(4) = a.tail(4);
  EXPECT_EQ(memory, (std::vector<double>{2, 3, 4, 5, 5}));
}

TEST(View, ChangesInPlace) {
  Matrix a{{1, 2}, {3, 4}};
  a.scale_rows(Vector{2, 10});
  EXPECT_TRUE(a == Matrix({{2, 4}, {30, 40}}));
  a.scale_cols(Vector{0.5, 1});
  EXPECT_TRUE(a == Matrix({{1, 4}, {15, 40}}));
  a.add_scaled(2.0, Matrix{{1, 1}, {1, 1}}).add_to_all(-1.0);
  EXPECT_TRUE(a == Matrix({{2, 5}, {16, 41}}));
  a.times_each_in_place(Matrix{{0, 1}, {1, 0}});
  EXPECT_TRUE(a == Matrix({{0, 5}, {16, 0}}));
  a /= 2.0;
  a += a;
  EXPECT_TRUE(a == Matrix({{0, 5}, {16, 0}}));
  a.top_rows(1).set_identity();
  EXPECT_TRUE(a == Matrix({{1, 0}, {16, 0}}));
}

TEST(View, NumbersOfAllEntriesDoNotDependOnSteps) {
  std::mt19937 random(1);
  for (const Index rows : {1, 2, 5, 9}) {
    for (const Index columns : {1, 3, 8}) {
      const Matrix large = random_matrix(random, 2 * rows, columns + 2);
      const ConstView part(large.data() + 1, rows, columns, 2, 2 * rows);
      double sum = 0.0, squares = 0.0, absolute = 0.0, largest = 0.0, least = part(0, 0);
      for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < columns; ++j) {
          sum += part(i, j);
          squares += part(i, j) * part(i, j);
          absolute += std::abs(part(i, j));
          largest = std::max(largest, std::abs(part(i, j)));
          least = std::min(least, part(i, j));
        }
      }
      for (const ConstView a : {part, part.transpose()}) {
        EXPECT_NEAR(a.sum(), sum, 1e-14);
        EXPECT_NEAR(a.mean(), sum / static_cast<double>(rows * columns), 1e-14);
        EXPECT_NEAR(a.squared_norm(), squares, 1e-13);
        EXPECT_NEAR(a.norm(), std::sqrt(squares), 1e-13);
        EXPECT_NEAR(a.sum_abs(), absolute, 1e-13);
        EXPECT_EQ(a.max_abs(), largest);
        EXPECT_EQ(a.min(), least);
        EXPECT_EQ((-a).max(), -least);
        EXPECT_NEAR(a.dot(a), squares, 1e-13);
      }
      // A row with a column.
      EXPECT_NEAR(part.row(0).dot(Vector(part.row(0))), part.row(0).squared_norm(), 1e-14);
    }
  }
}

TEST(View, NothingHasNumbersOfZeroAndNaNStays) {
  const ConstView nothing;
  EXPECT_EQ(nothing.max(), 0.0);
  EXPECT_EQ(nothing.min(), 0.0);
  EXPECT_EQ(nothing.max_abs(), 0.0);
  EXPECT_EQ(nothing.norm(), 0.0);
  EXPECT_EQ(nothing.index_of_max(), -1);
  EXPECT_TRUE(nothing.all_finite());
  for (const Vector& a : {Vector{nan_value, 1.0, 2.0}, Vector{1.0, nan_value, 2.0}, Vector{2.0, 1.0, nan_value}}) {
    EXPECT_TRUE(std::isnan(a.max()));
    EXPECT_TRUE(std::isnan(a.min()));
    EXPECT_TRUE(std::isnan(a.max_abs()));
    EXPECT_TRUE(std::isnan(a.norm()));
    EXPECT_FALSE(a.all_finite());
    EXPECT_FALSE(a.is_zero());
  }
  EXPECT_FALSE(Vector({0.0, std::numeric_limits<double>::infinity()}).all_finite());
}

TEST(View, PlacesOfTheLargestAndLeastAreTheFirstOnes) {
  const Vector a{1.0, 3.0, -2.0, 3.0, -2.0};
  EXPECT_EQ(a.index_of_max(), 1);
  EXPECT_EQ(a.index_of_min(), 2);
  EXPECT_EQ(a.transpose().index_of_max(), 1);
}

TEST(View, EntriesOneByOne) {
  const Matrix a{{-1, 4}, {9, -16}}, b{{2, 2}, {3, 4}};
  EXPECT_TRUE(a.abs() == Matrix({{1, 4}, {9, 16}}));
  EXPECT_TRUE(a.abs().square_roots() == Matrix({{1, 2}, {3, 4}}));
  EXPECT_TRUE(b.inverses() == Matrix({{0.5, 0.5}, {1.0 / 3.0, 0.25}}));
  EXPECT_TRUE(a.times_each(b) == Matrix({{-2, 8}, {27, -64}}));
  EXPECT_TRUE(a.over_each(b) == Matrix({{-0.5, 2}, {3, -4}}));
  EXPECT_TRUE(a.at_least(0.0) == Matrix({{0, 4}, {9, 0}}));
  EXPECT_TRUE(a.at_most(0.0) == Matrix({{-1, 0}, {0, -16}}));
  EXPECT_TRUE(a.at_least(b) == Matrix({{2, 4}, {9, 4}}));
  EXPECT_TRUE(a.at_most(b) == Matrix({{-1, 2}, {3, -16}}));
  EXPECT_TRUE(Vector({3, 4}).normalized() == Vector({0.6, 0.8}));
  EXPECT_TRUE(Vector({0, 0}).normalized() == Vector({0, 0}));
}

TEST(View, RowsAndColumnsOneByOne) {
  const Matrix a{{3, -4, 0}, {1, 1, 1}};
  EXPECT_TRUE(a.row_sums() == Vector({-1, 3}));
  EXPECT_TRUE(a.col_sums() == Vector({4, -3, 1}));
  EXPECT_TRUE(a.row_norms() == Vector({5, std::sqrt(3.0)}));
  EXPECT_TRUE(a.col_norms() == Vector({std::sqrt(10.0), std::sqrt(17.0), 1}));
  EXPECT_TRUE(a.row_max_abs() == Vector({4, 1}));
  EXPECT_EQ(Matrix(0, 3).col_sums().size(), 3);
  EXPECT_TRUE(Matrix(0, 3).col_sums().is_zero());
}

TEST(View, SelectsInAnyOrder) {
  const Matrix a{{1, 2, 3}, {4, 5, 6}};
  const std::vector<Index> rows{1, 0, 1}, columns{2, 0};
  EXPECT_TRUE(a.selected(rows, columns) == Matrix({{6, 4}, {3, 1}, {6, 4}}));
  EXPECT_TRUE(a.selected_rows(rows) == Matrix({{4, 5, 6}, {1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(a.selected_cols(columns) == Matrix({{3, 1}, {6, 4}}));
  EXPECT_TRUE(a.selected_cols(std::span<const Index>()).empty());
}

}  // namespace
}  // namespace saltus::linalg
