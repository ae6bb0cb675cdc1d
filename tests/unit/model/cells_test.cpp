// Cells as plain data: where an argument lies, and what its constants make of it.
#include "saltus/model/cells.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace saltus::model {
namespace {

double value(const CellTable& table, double argument) {
  const long cell = table.cell(argument);
  const double d = argument - table.constant(cell, 0);
  double slope = table.constant(cell, table.columns - 1);
  for (int column = table.columns - 2; column >= 2; --column) slope = table.constant(cell, column) + d * slope;
  return table.constant(cell, 1) + d * slope;
}

TEST(Cells, IntegersAreRightContinuousAlsoBelowZero) {
  const auto cells = integer_cells();
  for (const auto& [argument, cell] :
       {std::pair{0.0, 0L}, {0.999, 0L}, {1.0, 1L}, {-0.001, -1L}, {-1.0, -1L}, {-1.001, -2L}, {1e6 + 0.5, 1000000L}}) {
    EXPECT_EQ(cells.cell(argument), cell) << argument;
    EXPECT_EQ(cells.constant(cell, 0), std::floor(argument));
    EXPECT_LE(cells.lower(cell), argument);
    EXPECT_GT(cells.upper(cell), argument);
  }
  EXPECT_EQ(cells.cell(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_LT(cells.cell(-std::numeric_limits<double>::infinity()), cells.cell(0.0));
}

TEST(Cells, LinearTableInterpolatesAndIsConstantOutside) {
  const auto table = table_cells({0, 1, 3}, {1, 2, -2}, TableKind::linear);
  EXPECT_EQ(value(table, -5), 1);
  EXPECT_EQ(value(table, 0), 1);
  EXPECT_EQ(value(table, 0.25), 1.25);
  EXPECT_EQ(value(table, 1), 2);
  EXPECT_EQ(value(table, 2), 0);
  EXPECT_EQ(value(table, 3), -2);
  EXPECT_EQ(value(table, 1e9), -2);
  EXPECT_EQ(table.change, CellTable::Change::kink);
}

TEST(Cells, NotAKnotSplineReproducesCubics) {
  // The spline of points of a cubic is that cubic, whatever the spacing; so are four points of any function.
  const auto cubic = [](double x) { return 2 - x + 3 * x * x - 0.5 * x * x * x; };
  for (const auto& x : {std::vector<double>{-1, 0, 0.3, 2}, {-1, 0.5, 0.75, 1, 3, 3.5, 7}}) {
    std::vector<double> y;
    for (const double point : x) y.push_back(cubic(point));
    const auto table = table_cells(x, y, TableKind::cubic);
    for (double point = x.front(); point <= x.back(); point += 0.01) {
      EXPECT_NEAR(value(table, point), cubic(point), 1e-12) << point;
    }
    EXPECT_EQ(value(table, -2), y.front());
    EXPECT_EQ(value(table, 100), y.back());
  }
}

TEST(Cells, SplineIsTwiceDifferentiableAtItsPoints) {
  const std::vector<double> x{0, 0.5, 1.5, 2, 4, 4.5, 5}, y{0, 1, -1, 0.5, 0.25, 2, 1};
  const auto table = table_cells(x, y, TableKind::cubic);
  // Derivatives of the cells left and right of an inner point; the third one, too, at the first and last inner point.
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    const long left = static_cast<long>(k), right = left + 1;
    const auto c = [&](long cell, int column) { return table.constant(cell, column); };
    const double h = x[k] - x[k - 1];
    EXPECT_NEAR(c(left, 1) + h * (c(left, 2) + h * (c(left, 3) + h * c(left, 4))), y[k], 1e-14);
    EXPECT_NEAR(c(left, 2) + h * (2 * c(left, 3) + 3 * h * c(left, 4)), c(right, 2), 1e-12);
    EXPECT_NEAR(c(left, 3) + 3 * h * c(left, 4), c(right, 3), 1e-12);
    if (k == 1 || k + 2 == x.size()) {
      EXPECT_NEAR(c(left, 4), c(right, 4), 1e-12);
    }
  }
}

TEST(Cells, StepsHoldTheLastValueAndJoinEqualOnes) {
  const auto steps = step_cells({0, 1, 2, 3}, {5, 5, 7, 7});
  EXPECT_EQ(steps.breaks, (std::vector<double>{2}));
  EXPECT_EQ(steps.constant(steps.cell(-1), 0), 5);
  EXPECT_EQ(steps.constant(steps.cell(1.999), 0), 5);
  EXPECT_EQ(steps.constant(steps.cell(2), 0), 7);
  EXPECT_EQ(steps.constant(steps.cell(9), 0), 7);
  EXPECT_EQ(steps.change, CellTable::Change::jump);
}

TEST(Cells, MistakesNameThePoint) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto mistake = [](const std::vector<double>& x, const std::vector<double>& y, TableKind kind) {
    const auto found = find_mistake(x, y, kind);
    return found ? found->message + " @" + (found->point ? std::to_string(*found->point) : "-") : "";
  };
  EXPECT_EQ(mistake({0, 1}, {0, 1}, TableKind::linear), "");
  EXPECT_EQ(mistake({0, 1, 2}, {0, 1}, TableKind::linear), "3 arguments, but 2 values @-");
  EXPECT_EQ(mistake({0}, {1}, TableKind::linear), "expected at least 2 points for a linear table, found 1 @-");
  EXPECT_EQ(mistake({0, 1, 2}, {0, 1, 2}, TableKind::cubic),
            "expected at least 4 points for a cubic table, found 3 @-");
  EXPECT_EQ(mistake({0, 2, 1}, {0, 1, 2}, TableKind::linear), "the arguments must ascend, found 1 after 2 @2");
  EXPECT_EQ(mistake({0, 2, 2}, {0, 1, 2}, TableKind::linear), "the arguments must ascend, found 2 after 2 @2");
  EXPECT_EQ(mistake({0, infinite}, {0, 1}, TableKind::linear), "expected a finite number, found inf @1");
  EXPECT_EQ(mistake({0, 1e-320}, {0, 1}, TableKind::linear).substr(0, 9), "the slope");
  EXPECT_EQ(find_mistake(std::vector<double>{}, {})->message, "expected at least 1 point for an input, found 0");
  const std::vector<double> many(most_points + 1, 0.0);
  EXPECT_EQ(find_mistake(many, many)->message, "1000001 points; at most 1000000 are possible");
}

}  // namespace
}  // namespace saltus::model
