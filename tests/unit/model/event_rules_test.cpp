#include "saltus/model/statement/event_rules.hpp"

#include <gtest/gtest.h>

namespace saltus::model {
namespace {

using Fired = std::vector<std::size_t>;

bool no_condition(std::size_t, const double*) { return false; }

TEST(EventRules, AnExpressionFiresInItsDirection) {
  EventStates states({{false, {}, Direction::up}, {false, {}, Direction::down}, {false, {}, Direction::both}},
                     EventStates::Order::by_entry);
  EXPECT_EQ(states.update({-1, -1, -1}, no_condition), Fired{});
  EXPECT_EQ(states.update({1, 1, 1}, no_condition), (Fired{0, 2}));
  EXPECT_EQ(states.update({1, 1, 1}, no_condition), Fired{});
  EXPECT_EQ(states.update({-1, -1, -1}, no_condition), (Fired{1, 2}));
}

TEST(EventRules, AnExpressionThatStartsAtZeroHasNoSignToChange) {
  EventStates states({{false, {}, Direction::both}}, EventStates::Order::by_entry);
  EXPECT_EQ(states.update({0}, no_condition), Fired{});
  EXPECT_EQ(states.update({1}, no_condition), Fired{});
  EXPECT_EQ(states.update({0}, no_condition), Fired{});  // touches
  EXPECT_EQ(states.update({1}, no_condition), Fired{});
  EXPECT_EQ(states.update({-1}, no_condition), Fired{0});
}

TEST(EventRules, AConditionFiresWhereItsTruthChanges) {
  // a > 0 and b >= 0
  EventStates states({{true, {false, true}, Direction::both}}, EventStates::Order::by_entry);
  const auto both = [](std::size_t, const double* steps) { return steps[0] * steps[1] == 1.0; };
  EXPECT_EQ(states.update({0, 0}, both), Fired{});
  EXPECT_EQ(states.update({1, 0}, both), Fired{0});
  EXPECT_EQ(states.update({1, 1}, both), Fired{});
  EXPECT_EQ(states.update({1, -1}, both), Fired{0});
}

TEST(EventRules, SignsComeEntryByEntryOrExpressionsFirst) {
  const std::vector<EventRule> rules = {{true, {false, false}, Direction::up}, {false, {}, Direction::up}};
  std::vector<double> seen;
  const auto first_guard = [&](std::size_t entry, const double* steps) {
    EXPECT_EQ(entry, 0U);
    seen.assign(steps, steps + 2);
    return steps[0] == 1.0;
  };
  EventStates by_entry(rules, EventStates::Order::by_entry);
  EXPECT_EQ(by_entry.update({-1, 1, -1}, first_guard), Fired{});
  EXPECT_EQ(seen, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(by_entry.update({1, 1, 1}, first_guard), (Fired{0, 1}));
  EventStates expressions_first(rules, EventStates::Order::expressions_first);
  EXPECT_EQ(expressions_first.update({-1, -1, 1}, first_guard), Fired{});
  EXPECT_EQ(seen, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(expressions_first.update({-1, 1, 1}, first_guard), Fired{0});
}

}  // namespace
}  // namespace saltus::model
