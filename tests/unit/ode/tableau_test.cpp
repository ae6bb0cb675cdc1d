#include <algorithm>
#include <array>
#include <numeric>

#include <gtest/gtest.h>

#include "rooted_trees.hpp"
#include "saltus/ode/explicit/dop853_tableau.hpp"
#include "saltus/ode/explicit/dopri5_tableau.hpp"

namespace saltus::ode {
namespace {

using trial::OrderConditions;
using trial::Row;

// Coefficients are correct to half a rounding each and enter a condition at most eight times; sums have up to 16 terms
// in each of up to eight levels. 64 roundings of the terms' sizes are far below one wrong digit in one coefficient.
constexpr double roundings = 64.0;

template <class Tableau>
std::vector<Row> matrix() {
  std::vector<Row> rows;
  for (const auto& row : Tableau::a) rows.emplace_back(row.begin(), row.end());
  return rows;
}

template <class Tableau>
Row new_value_weights() {
  return matrix<Tableau>()[Tableau::stages - 1];
}

template <class Tableau>
Row embedded_weights(std::size_t which) {
  Row weights = new_value_weights<Tableau>();
  for (std::size_t i = 0; i < Tableau::stages; ++i) weights[i] -= Tableau::error[which][i];
  return weights;
}

/// Weights of the stages in x(t + theta h): the nested form with x(t) = 0 and h = 1, each stage in turn being 1.
template <class Tableau>
Row dense_weights(double theta) {
  const Row b = new_value_weights<Tableau>();
  Row weights(Tableau::dense_stages);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double bend = (i == 0 ? 1.0 : 0.0) - b[i];
    const double last = b[i] - (i == Tableau::stages - 1 ? 1.0 : 0.0) - bend;
    double inner = 0.0;
    for (std::size_t row = Tableau::dense.size(); row-- > 0;) {
      inner = Tableau::dense[row][i] + (row % 2 == 0 ? theta : 1.0 - theta) * inner;
    }
    weights[i] = theta * (b[i] + (1.0 - theta) * (bend + theta * (last + (1.0 - theta) * inner)));
  }
  return weights;
}

void expect_order(const OrderConditions& conditions, const Row& weights, std::size_t order, double theta = 1.0) {
  for (std::size_t k = 1; k <= order; ++k) {
    EXPECT_LT(conditions.defect(weights, k, theta).in_roundings, roundings) << "order " << k << ", theta " << theta;
  }
  // Not of the next order: the test can tell.
  EXPECT_GT(conditions.defect(weights, order + 1, theta).in_roundings, 1e6 * roundings);
}

template <class Tableau>
void expect_row_sums() {
  for (std::size_t i = 0; i < Tableau::dense_stages; ++i) {
    const auto& row = Tableau::a[i];
    const double size =
        std::accumulate(row.begin(), row.end(), 1.0, [](double s, double v) { return s + std::abs(v); });
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), Tableau::c[i], 1e-15 * size) << "row " << i;
    EXPECT_TRUE(std::all_of(row.begin() + static_cast<std::ptrdiff_t>(i), row.end(), [](double v) { return v == 0.0; }))
        << "row " << i << " is not explicit";
  }
}

TEST(RootedTrees, are_as_many_as_there_are) {
  const auto trees = trial::rooted_trees(9);
  const std::array<std::ptrdiff_t, 9> expected{1, 1, 2, 4, 9, 20, 48, 115, 286};
  for (std::size_t order = 1; order <= 9; ++order) {
    EXPECT_EQ(std::count_if(trees.begin(), trees.end(), [&](const auto& tree) { return tree.order == order; }),
              expected[order - 1]);
  }
}

TEST(Dopri5Tableau, row_sums_are_the_nodes) { expect_row_sums<Dopri5Tableau>(); }

TEST(Dop853Tableau, row_sums_are_the_nodes) { expect_row_sums<Dop853Tableau>(); }

TEST(Dopri5Tableau, orders_of_new_value_embedded_value_and_dense_output) {
  const OrderConditions conditions(matrix<Dopri5Tableau>(), 6);
  expect_order(conditions, new_value_weights<Dopri5Tableau>(), 5);
  expect_order(conditions, embedded_weights<Dopri5Tableau>(0), 4);
  for (const double theta : {0.1, 0.3, 0.6, 0.9})
    expect_order(conditions, dense_weights<Dopri5Tableau>(theta), 4, theta);
}

TEST(Dop853Tableau, orders_of_new_value_embedded_values_and_dense_output) {
  const OrderConditions conditions(matrix<Dop853Tableau>(), 9);
  expect_order(conditions, new_value_weights<Dop853Tableau>(), 8);
  expect_order(conditions, embedded_weights<Dop853Tableau>(0), 5);
  expect_order(conditions, embedded_weights<Dop853Tableau>(1), 3);
  for (const double theta : {0.1, 0.3, 0.6, 0.9})
    expect_order(conditions, dense_weights<Dop853Tableau>(theta), 7, theta);
}

}  // namespace
}  // namespace saltus::ode
