#include <fmt/format.h>

#include "saltus/model/recognition/guards_internal.hpp"

namespace saltus::model {

Expected<Truth> Guards::truth(const Condition& condition) {
  switch (condition.kind()) {
    case Condition::Kind::constant:
      return condition.truth() > 0.0 ? 1 : 0;
    case Condition::Kind::comparison:
      return comparison_truth(condition.comparison());
    case Condition::Kind::negation:
      return truth(condition.left()).map([&](Truth a) { return diagram_.negation(a); });
    case Condition::Kind::conjunction:
    case Condition::Kind::disjunction:
      break;
  }
  const auto a = truth(condition.left());
  if (!a) return a;
  const auto b = truth(condition.right());
  if (!b) return b;
  return condition.kind() == Condition::Kind::conjunction ? diagram_.conjunction(*a, *b) : diagram_.disjunction(*a, *b);
}

/// One symbol per guard. A condition that folded still is one: it gets a guard that never changes.
std::vector<SXElem> Guards::finish(std::vector<bool>& true_at_equality) {
  if (guards_.empty()) static_cast<void>(guard(recognition_.graph.node(SXElem(1.0)), AtEquality::is_false));
  std::vector<SXElem> symbols;
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    symbols.push_back(SXElem::sym(fmt::format("guard_alpha_{}", i)));
    true_at_equality.push_back(guards_[i].at_equality == AtEquality::is_true);
  }
  return symbols;
}

casadi::SX Guards::differences() const {
  std::vector<SXElem> differences;
  for (const auto& guard : guards_) differences.push_back(recognition_.graph.expression(guard.node));
  return column(differences);
}

int Guards::guard(int node, AtEquality at_equality) {
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    if (guards_[i].node == node && guards_[i].at_equality == at_equality) return static_cast<int>(i);
  }
  guards_.push_back({node, at_equality});
  return static_cast<int>(guards_.size()) - 1;
}

Expected<Truth> Guards::comparison_truth(const Comparison& comparison) {
  const auto difference = recognition_.difference_of(comparison);
  if (!difference) return tl::unexpected(difference.error());
  const auto both = recognition_.both_values(*difference);
  if (!both) return tl::unexpected(both.error());
  if (*both) return truth_at_both(comparison, **both);
  const auto node = recognition_.graph.add(*difference);
  if (!node) return tl::unexpected(node.error());
  const auto constant = constant_value(recognition_.graph.tape(), *node);
  if (!constant) return diagram_.literal(guard(*node, comparison.at_equality));
  recognition_.note({.kind = Decision::Kind::sign, .node = *node},
                    [&] { return fmt::format("'{}'", casadi::SX(*difference).get_str()); });
  const bool holds = *constant > 0.0 || (*constant == 0.0 && comparison.at_equality == AtEquality::is_true);
  return holds ? TruthDiagram::constant_true() : TruthDiagram::constant_false();
}

Expected<Truth> Guards::truth_at_both(Comparison comparison, const BothValues& both) {
  comparison.difference = both.at_one;
  const auto one = comparison_truth(comparison);
  if (!one) return one;
  comparison.difference = both.at_zero;
  const auto zero = comparison_truth(comparison);
  if (!zero) return zero;
  const int psi = recognition_.functions()[at(both.function)].psi_node;
  return diagram_.choice(diagram_.literal(guard(psi, AtEquality::is_false)), *one, *zero);
}

}  // namespace saltus::model
