#include "saltus/switching/selections/column_flats.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "saltus/linalg/factors.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using Members = std::vector<bool>;

Index rank_of(const Matrix& columns) {
  linalg::PivotedQr qr(columns);
  qr.set_threshold(1e-9);
  return qr.rank();
}

Members span_of(const Matrix& columns, const std::vector<Index>& choice) {
  Members members;
  for (Index i = 0; i < columns.cols(); ++i) {
    auto with = choice;
    with.push_back(i);
    members.push_back(rank_of(columns.selected_cols(with)) == static_cast<Index>(choice.size()));
  }
  return members;
}

/// All choices of r - 1 columns, one after the other; the first one of each hyperplane.
std::vector<std::vector<Index>> by_all_choices(const Matrix& columns) {
  const auto q = static_cast<std::size_t>(columns.cols());
  std::vector<std::vector<Index>> bases;
  std::set<Members> known;
  std::vector<bool> taken(q, false);
  std::fill_n(taken.begin(), columns.rows() - 1, true);
  do {
    std::vector<Index> choice;
    for (std::size_t i = 0; i < q; ++i) {
      if (taken[i]) choice.push_back(static_cast<Index>(i));
    }
    if (rank_of(columns.selected_cols(choice)) == columns.rows() - 1 && known.insert(span_of(columns, choice)).second) {
      bases.push_back(choice);
    }
  } while (std::prev_permutation(taken.begin(), taken.end()));
  return bases;
}

TEST(ColumnFlats, AreThoseOfAllChoices) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> small(-1, 1);
  int compared = 0;
  while (compared < 60) {
    const Index r = 2 + compared % 3, q = r + 1 + compared % 5;
    // Small integers, so that many of them lie in one hyperplane, some are parallel, some zero; of different sizes.
    Matrix columns(r, q);
    for (Index i = 0; i < q; ++i) {
      for (Index j = 0; j < r; ++j) columns(j, i) = std::pow(10.0, i % 4) * small(random);
    }
    if (rank_of(columns) < r) continue;
    const auto found = column_hyperplanes(columns, 1000);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(*found, by_all_choices(columns)) << compared;
    ++compared;
  }
}

/// 4 x 9.
Matrix in_general_position() {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Matrix columns(4, 9);
  for (double& value : columns) value = entry(random);
  return columns;
}

TEST(ColumnFlats, InGeneralPositionAreAllChoices) {
  const auto found = column_hyperplanes(in_general_position(), 1000);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->size(), 84U);
}

TEST(ColumnFlats, OneRowHasOneHyperplane) {
  const auto found = column_hyperplanes(Matrix::constant(1, 3, 1.0), 10);
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_TRUE(found->front().empty());
}

TEST(ColumnFlats, StopAtTheirLimit) {
  EXPECT_FALSE(column_hyperplanes(in_general_position(), 50).has_value());
  EXPECT_FALSE(column_hyperplanes(Matrix::constant(2, 2, 1.0 / 0.0), 50).has_value());
}

}  // namespace
}  // namespace saltus::switching
