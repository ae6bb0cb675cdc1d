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

/// The largest distance of lines between places from the values.
double farthest(const std::vector<double>& t, const std::vector<double>& values,
                const std::vector<std::size_t>& places) {
  double most = 0.0;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const std::size_t from = places[k], to = places[k + 1];
    for (std::size_t i = from + 1; i < to; ++i) {
      const double part = t[to] == t[from] ? 0.0 : (t[i] - t[from]) / (t[to] - t[from]);
      most = std::max(most, std::abs(values[from] + part * (values[to] - values[from]) - values[i]));
    }
  }
  return most;
}

TEST(Thinning, LinesBetweenPlacesAreAsCloseAsTheyShouldBe) {
  std::vector<double> t, values;
  for (int i = 0; i < 5000; ++i) {
    t.push_back(1e-3 * i + 4e-4 * std::sin(7.0 * i));
    values.push_back(std::sin(20.0 * t.back()) + 0.01 * std::sin(311.0 * i));
  }
  std::sort(t.begin(), t.end());
  std::size_t before = t.size();
  for (const double tolerance : {1e-3, 1e-2, 1e-1}) {
    const auto places = straight_places(t, values, tolerance);
    EXPECT_EQ(places.front(), 0U);
    EXPECT_EQ(places.back(), t.size() - 1);
    EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
    EXPECT_LE(farthest(t, values, places), tolerance * (1.0 + 1e-9));
    EXPECT_LE(places.size(), before);
    before = places.size();
  }
  EXPECT_LT(before, 200U);
  // A constant is its ends, exactly.
  EXPECT_EQ(straight_places(t, std::vector<double>(t.size(), 0.1), 0.0).size(), 2U);
}

TEST(Thinning, BothSidesOfJumpsAndOfGapsAreKept) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> t{0, 1, 2, 3, 3, 4, 5, 6, 7, 8}, values{0, 1, 2, 3, -3, -2, nan, nan, 0, 0};
  EXPECT_EQ(straight_places(t, values, 1e-3), (std::vector<std::size_t>{0, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_TRUE(straight_places({}, {}, 1.0).empty());
  EXPECT_EQ(straight_places({1}, {2}, 1.0), (std::vector<std::size_t>{0}));
}

}  // namespace
}  // namespace saltus::report
