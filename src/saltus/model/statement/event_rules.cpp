#include "saltus/model/statement/event_rules.hpp"

#include <utility>

#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

bool is_wanted(Direction direction, int change) {
  if (direction == Direction::both) return change != 0;
  return direction == Direction::up ? change > 0 : change < 0;
}

std::size_t signs_of(const EventRule& rule) { return rule.condition ? rule.true_at_equality.size() : 1; }

}  // namespace

EventRule rule_of(const UserEvent& event) {
  return {event.guards.numel() > 0, event.true_at_equality, event.direction};
}

EventRule rule_of(const Layout::Event& event) {
  EventRule rule{event.is_condition(), {}, event.direction};
  for (const auto& guard : event.guards) rule.true_at_equality.push_back(guard.true_at_equality);
  return rule;
}

EventStates::EventStates(std::vector<EventRule> rules, Order order)
    : rules_(std::move(rules)), first_(rules_.size()), state_(rules_.size(), 0) {
  std::size_t next = 0;
  const auto place = [&](auto&& belongs) {
    for (std::size_t e = 0; e < rules_.size(); ++e) {
      if (!belongs(rules_[e])) continue;
      first_[e] = next;
      next += signs_of(rules_[e]);
    }
  };
  if (order == Order::by_entry) {
    place([](const EventRule&) { return true; });
  } else {
    place([](const EventRule& rule) { return !rule.condition; });
    place([](const EventRule& rule) { return rule.condition; });
  }
}

std::vector<std::size_t> EventStates::update(const std::vector<int>& signs, Truth truth) {
  std::vector<std::size_t> fired;
  for (std::size_t e = 0; e < rules_.size(); ++e) {
    const EventRule& rule = rules_[e];
    int now = signs[first_[e]];
    bool known = started_;
    if (rule.condition) {
      steps_.clear();
      for (std::size_t g = 0; g < rule.true_at_equality.size(); ++g) {
        const int sign = signs[first_[e] + g];
        steps_.push_back(sign > 0 || (sign == 0 && rule.true_at_equality[g]) ? 1.0 : 0.0);
      }
      now = truth(e, steps_.data()) ? 1 : 0;
    } else {
      if (now == 0) continue;
      known = state_[e] != 0;
    }
    if (known && is_wanted(rule.direction, now - state_[e])) fired.push_back(e);
    state_[e] = now;
  }
  started_ = true;
  return fired;
}

}  // namespace saltus::model
