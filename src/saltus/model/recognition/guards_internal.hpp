// The conditions of [[events]] and [[jumps]]: comparisons become guards.
#pragma once

#include <vector>

#include "saltus/model/recognition/recognition_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Turns the comparisons of one condition into guards; those of constants fold.
class Guards {
 public:
  explicit Guards(Recognition& recognition) : recognition_(recognition) {}

  /// Returns where the condition holds, as a function of the guards.
  [[nodiscard]] Expected<Truth> truth(const Condition& condition);
  /// Fills guards, guard_alpha, true_at_equality and value of a UserEvent or Jump.
  template <class Entry>
  void fill(Entry& entry, Truth truth) {
    auto symbols = finish(entry.true_at_equality);
    entry.guards = differences();
    entry.guard_alpha = column(symbols);
    entry.value = recognition_.graph.polynomial(diagram_, truth, symbols);
  }
  /// Returns whether the condition is too large for a table of its truth.
  [[nodiscard]] bool overflowed() const { return diagram_.overflowed(); }

 private:
  struct Guard {
    int node;
    AtEquality at_equality;
  };
  [[nodiscard]] std::vector<SXElem> finish(std::vector<bool>& true_at_equality);
  [[nodiscard]] casadi::SX differences() const;
  int guard(int node, AtEquality at_equality);
  [[nodiscard]] Expected<Truth> comparison_truth(const Comparison& comparison);
  [[nodiscard]] Expected<Truth> truth_at_both(Comparison comparison, const BothValues& both);

  Recognition& recognition_;
  TruthDiagram diagram_;
  std::vector<Guard> guards_;
};

}  // namespace saltus::model
