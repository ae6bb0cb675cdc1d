// What [[events]] make of the signs of their functions: plain rules, the same for every engine.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/model/roles.hpp"

namespace saltus::model {

struct UserEvent;

/// Holds when an entry of [[events]] fires.
struct EventRule {
  bool condition = false;              ///< else an expression
  std::vector<bool> true_at_equality;  ///< by guard of a condition
  Direction direction = Direction::both;
};

[[nodiscard]] EventRule rule_of(const UserEvent& event);
[[nodiscard]] EventRule rule_of(const Layout::Event& event);

/// Follows signs of expressions and truths of conditions, and says which entries fire where they change: an expression
/// whose sign has changed in its direction, a condition whose truth has.
class EventStates {
 public:
  /// Says the order of the signs handed to update(): entry by entry, or those of all expressions and then the guards of
  /// conditions.
  enum class Order { by_entry, expressions_first };
  EventStates(std::vector<EventRule> rules, Order order);

  /// Truth of the condition of an entry from the steps of its guards, 0 or 1.
  using Truth = FunctionRef<bool(std::size_t entry, const double* guard_steps)>;
  /// Takes the signs (-1, 0, 1) in force from now on; an expression at 0 has not left the zero it started from. The
  /// first call fires nothing.
  /// @return entries that fire, ascending. Cost: one evaluation for every condition.
  [[nodiscard]] std::vector<std::size_t> update(const std::vector<int>& signs, Truth truth);

 private:
  std::vector<EventRule> rules_;
  std::vector<std::size_t> first_;  ///< sign of every entry, the others follow
  std::vector<int> state_;          ///< sign of an expression, truth (0 or 1) of a condition
  std::vector<double> steps_;
  bool started_ = false;
};

}  // namespace saltus::model
