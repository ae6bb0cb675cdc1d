// The conditions of [[events]]: comparisons become guards.
#pragma once

#include <vector>

#include "saltus/model/recognition_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Turns the comparisons of one condition into guards; those of constants fold.
class Guards {
 public:
  explicit Guards(Recognition& recognition) : recognition_(recognition) {}

  /// Where the condition holds, as a function of the guards.
  [[nodiscard]] Expected<Truth> truth(const Condition& condition);
  /// Fills guards, guard_alpha, true_at_equality and value.
  void fill(UserEvent& event, Truth truth);
  /// The condition is too large for a table of its truth.
  [[nodiscard]] bool overflowed() const { return diagram_.overflowed(); }

 private:
  struct Guard {
    int node;
    AtEquality at_equality;
  };
  int guard(int node, AtEquality at_equality);
  [[nodiscard]] Expected<Truth> comparison_truth(const Comparison& comparison);

  Recognition& recognition_;
  TruthDiagram diagram_;
  std::vector<Guard> guards_;
};

}  // namespace saltus::model
