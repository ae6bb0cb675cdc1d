// Rows and events that are kept as columns.
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/result/result.hpp"

namespace saltus::result {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> list_of(const SteadyTable<double>& table, std::size_t row) { return table[row]; }

TEST(Table, HasItsRowsOneAfterTheOther) {
  Table<double> table{{1, 2}, {3, 4}, {5, 6}};
  EXPECT_EQ(table[1], (std::vector<double>{3, 4}));
  EXPECT_EQ(table.data()[3], 4.0);
  table.push_back(table[0]);  // a row of its own
  table.change(1)[1] = 7;
  table.keep({0, 1, 3});
  EXPECT_EQ(table, (Table<double>{{1, 2}, {3, 7}, {1, 2}}));
  table.narrow(1);
  EXPECT_EQ(table, (Table<double>{{1}, {3}, {1}}));
  table.pop_back();
  EXPECT_EQ(table.size(), 2U);
}

TEST(Table, CountsRowsWithoutColumns) {
  Table<double> table{{}, {}};
  table.push_back(std::vector<double>{});
  EXPECT_EQ(table.size(), 3U);
  EXPECT_TRUE(table.back().empty());
}

TEST(SteadyTable, GivesEveryRowBack) {
  // Columns that never change, change now and then, and change in every row.
  SteadyTable<double> table;
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 100; ++i) rows.push_back({0.5, i < 30 || i >= 60 ? 0.0 : 1.0, 0.25 * i});
  for (const auto& row : rows) table.push_back(row);
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(list_of(table, i), rows[i]) << i;
  for (int i = 0; i < 50; ++i) table.pop_back();
  table.repeat();
  EXPECT_EQ(list_of(table, 50), rows[49]);
  table.push_back(rows[7]);
  EXPECT_EQ(list_of(table, 51), rows[7]);
  EXPECT_EQ(list_of(table, 30), rows[30]);
  table.keep({2, 30, 51});
  EXPECT_EQ(table.size(), 3U);
  EXPECT_EQ(list_of(table, 1), rows[30]);
  EXPECT_EQ(list_of(table, 2), rows[7]);
}

TEST(SteadyTable, ForgetsItsOnlyRowBehindOneThatMayNotBeRead) {
  SteadyTable<double> table;
  table.repeat();
  table.push_back({1.0, 2.0});
  table.pop_back();
  table.push_back({3.0, 4.0});
  EXPECT_EQ(table.size(), 2U);
  EXPECT_EQ(list_of(table, 1), (std::vector<double>{3.0, 4.0}));
}

TEST(SteadyTable, KeepsBits) {
  SteadyTable<double> table{{0.0}, {-0.0}, {nan}, {nan}, {1.0}};
  EXPECT_FALSE(std::signbit(table[0][0]));
  EXPECT_TRUE(std::signbit(table[1][0]));
  EXPECT_TRUE(std::isnan(table[2][0]) && std::isnan(table[3][0]));
  int changes = 0;
  table.column(0).for_each_change([&](std::size_t, double) { ++changes; });
  EXPECT_EQ(changes, 4);
}

Event crossing(double t) {
  Event event;
  event.t = t;
  event.surfaces = {"a", "b"};
  event.mode_before = Mode{-1, 1};
  event.mode_after = Mode{1, 1};
  event.alpha_before = std::vector<double>{0.0, nan};
  event.alpha_after = std::vector<double>{1.0, 0.25};
  event.x = event.x_after = {t, -0.0};
  event.reason = "passed";
  return event;
}

void expect_same(const Event& is, const Event& should) {
  EXPECT_EQ(is.t, should.t);
  EXPECT_EQ(is.kind, should.kind);
  EXPECT_EQ(is.name, should.name);
  EXPECT_EQ(is.surfaces, should.surfaces);
  EXPECT_EQ(is.mode_before, should.mode_before);
  EXPECT_EQ(is.mode_after, should.mode_after);
  EXPECT_EQ(is.alpha_after, should.alpha_after);
  EXPECT_EQ(is.alpha_before.has_value(), should.alpha_before.has_value());
  EXPECT_EQ(is.x, should.x);
  EXPECT_EQ(is.x_after, should.x_after);
  EXPECT_EQ(is.unique, should.unique);
  EXPECT_EQ(is.alternatives.size(), should.alternatives.size());
  EXPECT_EQ(is.reason, should.reason);
}

TEST(Events, GiveEveryEventBack) {
  Event start = crossing(0.0);
  start.kind = EventKind::start;
  start.mode_before.reset();
  start.alpha_before.reset();
  start.unique = false;
  start.alternatives = {{{0, 1}, {0.5, 1.0}}};
  Event jump = crossing(1.0);
  jump.kind = EventKind::jump;
  jump.name = "";
  jump.surfaces.clear();
  jump.x_after = {2.0, 3.0};
  jump.mode_after.reset();
  jump.alpha_after.reset();
  jump.unique = std::nullopt;
  jump.impulse = {{1.0, 0.0}};
  const std::vector<Event> all{start, crossing(0.5), jump, crossing(1.5), crossing(2.0)};
  Events events = all;
  ASSERT_EQ(events.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same(events[i], all[i]);
    EXPECT_EQ(events.t(i), all[i].t);
    EXPECT_EQ(events.alternatives(i), all[i].alternatives.size());
    EXPECT_EQ(events.mode_before(i).has_value(), all[i].mode_before.has_value());
  }
  EXPECT_EQ(events[2].impulse->size(), 1U);
  EXPECT_FALSE(events[3].impulse.has_value());
  EXPECT_TRUE(std::isnan((*events[1].alpha_before)[1]));
  // Behind what was taken away events go on as if it had not been there.
  for (int i = 0; i < 3; ++i) events.pop_back();
  events.push_back(jump);
  events.push_back(crossing(3.0));
  expect_same(events[2], jump);
  expect_same(events.back(), crossing(3.0));
  EXPECT_EQ(std::vector<Event>(events).size(), 4U);
}

TEST(Trajectory, AppendsAndKeepsRowsOfAllColumns) {
  Trajectory rows;
  for (int i = 0; i < 4; ++i) {
    rows.t.push_back(i);
    rows.x.push_back({1.0 * i, 2.0});
    rows.alpha.push_back({i < 2 ? 0.0 : 0.5});
    rows.mode.push_back({i < 2 ? -1 : 0});
    rows.regions.push_back({{i < 2 ? "left" : "right"}});
  }
  rows.append(Trajectory(rows), 1);
  rows.keep({0, 2, 4});
  EXPECT_EQ(rows.t, (std::vector<double>{0, 2, 1}));
  EXPECT_EQ(rows.x, (Table<double>{{0, 2}, {2, 2}, {1, 2}}));
  EXPECT_EQ(rows.alpha[1], std::vector<double>{0.5});
  EXPECT_EQ(rows.mode[2], Mode{-1});
  EXPECT_EQ(rows.regions[1], (Regions{{"right"}}));
  EXPECT_TRUE(rows.outputs.empty());
}

}  // namespace
}  // namespace saltus::result
