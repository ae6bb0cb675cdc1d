// Rows at events for pictures of results that have none.
#include "saltus/result/drawn.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/result/kept_columns.hpp"

namespace saltus::result {
namespace {

/// A ball at rows 0, 1, 2, which is thrown back at t = 0.5, where an output jumps and another one does not.
Result thrown_back() {
  Result result;
  result.states = {"h", "v"};
  result.switching_functions = {"s"};
  result.outputs = {"jumps", "stays"};
  auto& rows = result.trajectory;
  rows.t = {0.0, 1.0, 2.0};
  rows.x = Table<double>{{1, -2}, {1, 2}, {3, 2}};
  rows.outputs = Table<double>{{5, 7}, {6, 7}, {6, 7}};
  rows.alpha = SteadyTable<double>{{0}, {1}, {1}};
  rows.mode = SteadyTable<signed char>{{-1}, {1}, {1}};
  Event event;
  event.t = 0.5;
  event.kind = EventKind::jump;
  event.x = {0, -2};
  event.x_after = {0, 2};
  event.mode_before = {-1}, event.mode_after = {1};
  event.alpha_before = {{0.25}}, event.alpha_after = {{1}};
  result.events.push_back(event);
  return result;
}

TEST(AsDrawn, HasBothSidesOfAnEventBetweenRows) {
  const auto drawn = as_drawn(thrown_back());
  ASSERT_TRUE(drawn);
  const auto& rows = drawn->trajectory;
  EXPECT_EQ(rows.t, (std::vector<double>{0, 0.5, 0.5, 1, 2}));
  EXPECT_EQ(rows.x, (Table<double>{{1, -2}, {0, -2}, {0, 2}, {1, 2}, {3, 2}}));
  EXPECT_EQ(rows.alpha, (SteadyTable<double>{{0}, {0.25}, {1}, {1}, {1}}));
  EXPECT_EQ(rows.mode, (SteadyTable<signed char>{{-1}, {-1}, {1}, {1}, {1}}));
  for (const std::size_t row : {1U, 2U}) {
    EXPECT_TRUE(std::isnan(rows.outputs[row][0])) << "the event does not know it";
    EXPECT_EQ(rows.outputs[row][1], 7.0);
  }
}

TEST(AsDrawn, KeepsTheRowBehindAnEvent) {
  auto result = thrown_back();
  result.trajectory.t[1] = 0.5;
  const auto drawn = as_drawn(result);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->trajectory.t, (std::vector<double>{0, 0.5, 0.5, 2}));
  EXPECT_EQ(drawn->trajectory.x, (Table<double>{{1, -2}, {0, -2}, {1, 2}, {3, 2}}));
  EXPECT_EQ(drawn->trajectory.outputs[2][0], 6.0);
}

TEST(AsDrawn, LeavesResultsThatHaveTheirRows) {
  const auto drawn = as_drawn(thrown_back());
  ASSERT_TRUE(drawn);
  EXPECT_FALSE(as_drawn(*drawn));
  auto without_rows = thrown_back();
  without_rows.trajectory = {};
  EXPECT_FALSE(as_drawn(without_rows));
  auto outside = thrown_back();
  outside.trajectory.t = {0.6, 1.0, 2.0};
  EXPECT_FALSE(as_drawn(outside));
}

TEST(AsDrawn, CompletesBranchesAndColumnsThatAreKept) {
  Result root = thrown_back();
  root.trajectory.t = {0.5, 0.5, 2.0};
  root.branches.push_back(thrown_back());
  auto& kept = root.branches.front();
  kept.kept = KeptColumns{{1}, {}};
  keep_columns(*kept.kept, kept.trajectory);
  root.kept = KeptColumns{{0, 1}, {0}};
  const auto drawn = as_drawn(root);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->trajectory.t, root.trajectory.t);
  EXPECT_EQ(drawn->branches.front().trajectory.x, (Table<double>{{-2}, {-2}, {2}, {2}, {2}}));
}

TEST(AsDrawn, MovesBodiesOnStraightLines) {
  auto result = thrown_back();
  result.drawing = Drawing{{{true, 1}}, {{0, 0, 1}, {4, 2, 1}, {4, 2, 1}}};
  const auto drawn = as_drawn(result);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->drawing->rows,
            (std::vector<std::vector<double>>{{0, 0, 1}, {2, 1, 1}, {2, 1, 1}, {4, 2, 1}, {4, 2, 1}}));
}

TEST(AsDrawn, PutsJumpsOfOneTimeInTheirOrder) {
  auto result = thrown_back();
  Event second = result.events[0];
  second.x = {0, 2};
  second.x_after = {0, 3};
  second.mode_before.reset();
  result.events.push_back(second);
  const auto drawn = as_drawn(result);
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->trajectory.x, (Table<double>{{1, -2}, {0, -2}, {0, 2}, {0, 2}, {0, 3}, {1, 2}, {3, 2}}));
  EXPECT_EQ(drawn->trajectory.mode[3][0], 1);
}

}  // namespace
}  // namespace saltus::result
