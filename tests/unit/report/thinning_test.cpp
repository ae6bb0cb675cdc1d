#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "saltus/report/thinning_internal.hpp"
#include "sample_results.hpp"

namespace saltus::report {
namespace {

bool contains(const std::vector<std::size_t>& rows, std::size_t row) {
  return std::binary_search(rows.begin(), rows.end(), row);
}

TEST(Thinning, ShortTrajectoriesStayWhole) {
  const auto trajectory = report_samples::stick_slip(4, 10).trajectory;
  const auto rows = rows_to_draw(trajectory, trajectory.t.size());
  ASSERT_EQ(rows.size(), trajectory.t.size());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i], i);
}

TEST(Thinning, AnEmptyTrajectoryHasNoRows) { EXPECT_TRUE(rows_to_draw({}, 10).empty()); }

TEST(Thinning, BothRowsOfEveryEventAndTheEndsStay) {
  const auto trajectory = report_samples::stick_slip(40, 500).trajectory;
  const auto rows = rows_to_draw(trajectory, 300);
  EXPECT_LT(rows.size(), 400U);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  EXPECT_TRUE(contains(rows, 0));
  EXPECT_TRUE(contains(rows, trajectory.t.size() - 1));
  std::size_t pairs = 0;
  for (std::size_t i = 1; i < trajectory.t.size(); ++i) {
    if (trajectory.t[i - 1] != trajectory.t[i]) continue;
    ++pairs;
    EXPECT_TRUE(contains(rows, i - 1));
    EXPECT_TRUE(contains(rows, i));
  }
  EXPECT_EQ(pairs, 40U);
}

TEST(Thinning, OfVeryManyEventsSomeKeepTheirRows) {
  const auto trajectory = report_samples::stick_slip(2000, 3).trajectory;
  const std::size_t limit = 800;
  const auto rows = rows_to_draw(trajectory, limit);
  EXPECT_LE(rows.size(), limit + limit / 2 + 2 * number_of_columns(trajectory));
  std::size_t pairs = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) pairs += trajectory.t[rows[i - 1]] == trajectory.t[rows[i]] ? 1U : 0U;
  EXPECT_GE(pairs, limit / 8);
  EXPECT_TRUE(contains(rows, trajectory.t.size() - 1));
}

TEST(Thinning, OnlyTheColumnsThatAreDrawnCount) {
  result::Trajectory trajectory;
  for (int i = 0; i < 5000; ++i) {
    trajectory.t.push_back(i);
    trajectory.x.push_back({i == 1234 ? -7.0 : 0.0, 0.0, i == 777 ? 1.0 : 0.0});
  }
  const auto rows = rows_to_draw(trajectory, 100, 2);
  EXPECT_TRUE(contains(rows, 1234));
  EXPECT_FALSE(contains(rows, 777));
  EXPECT_EQ(number_of_columns(trajectory, 2), 2U);
}

TEST(Thinning, ExtremesOfEveryColumnSurvive) {
  result::Trajectory trajectory;
  for (int i = 0; i < 5000; ++i) {
    trajectory.t.push_back(i);
    trajectory.x.push_back({std::sin(0.01 * i), i == 1234 ? -7.0 : 0.0});
    trajectory.outputs.push_back({i == 4321 ? 9.0 : 0.0});
  }
  const auto rows = rows_to_draw(trajectory, 100);
  EXPECT_LE(rows.size(), 102U);
  EXPECT_TRUE(contains(rows, 1234));
  EXPECT_TRUE(contains(rows, 4321));
}

TEST(Thinning, AModeThatChangesWithoutAnEventStays) {
  result::Trajectory trajectory;
  for (int i = 0; i < 1000; ++i) {
    trajectory.t.push_back(i);
    trajectory.x.push_back({0.0});
    trajectory.mode.push_back({i < 617 ? -1 : 1});
  }
  const auto rows = rows_to_draw(trajectory, 20);
  EXPECT_TRUE(contains(rows, 616));
  EXPECT_TRUE(contains(rows, 617));
}

TEST(Thinning, TheFirstValueThatIsNotFiniteStays) {
  result::Trajectory trajectory;
  for (int i = 0; i < 1000; ++i) {
    trajectory.t.push_back(i);
    trajectory.x.push_back({i == 500 ? std::numeric_limits<double>::quiet_NaN() : 1.0 * i});
  }
  EXPECT_TRUE(contains(rows_to_draw(trajectory, 20), 500));
}

TEST(Thinning, CountsTheColumnsOfAllTables) {
  EXPECT_EQ(number_of_columns(report_samples::twelve_states().trajectory), 12U + 4U + 2U + 2U);
  EXPECT_EQ(number_of_columns({}), 0U);
}

}  // namespace
}  // namespace saltus::report
