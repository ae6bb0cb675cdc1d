// Values at an instant, as a jump sets them: comparisons are what their operators say of equality.
#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {
namespace {

/// 1 where a quantity is beyond a limit, or at it where that counts; else 0.
SXElem beyond(const SXElem& limit, const SXElem& quantity, bool at_limit) {
  return SXElem::binary(at_limit ? casadi::OP_LE : casadi::OP_LT, limit, quantity);
}

/// In the order of truth_of().
std::vector<Comparison> comparisons_of(const Condition& condition) {
  std::vector<Comparison> found;
  std::vector<Condition> open{condition};
  while (!open.empty()) {
    const Condition current = open.back();
    open.pop_back();
    if (current.kind() == Condition::Kind::comparison) found.push_back(current.comparison());
    if (current.kind() == Condition::Kind::comparison || current.kind() == Condition::Kind::constant) continue;
    if (current.kind() != Condition::Kind::negation) open.push_back(current.right());
    open.push_back(current.left());
  }
  return found;
}

/// The truth of a condition from those of its comparisons.
SXElem truth_of(const Condition& condition, std::vector<SXElem>::const_iterator& next) {
  if (condition.kind() == Condition::Kind::constant) return SXElem(condition.truth());
  if (condition.kind() == Condition::Kind::comparison) return *next++;
  const SXElem a = truth_of(condition.left(), next);
  if (condition.kind() == Condition::Kind::negation) return 1.0 - a;
  const SXElem b = truth_of(condition.right(), next);
  return condition.kind() == Condition::Kind::conjunction ? a * b : a + b - a * b;
}

}  // namespace

/// The truth of a condition in an expression, which remembers the condition.
SXElem Recognition::marked(const SXElem& truth, const Condition& condition) {
  const SXElem mark = graph.marked(truth);
  conditions_.insert_or_assign(mark.get(), condition);
  return mark;
}

/// A condition whose comparisons leave it no value but on surfaces: x >= 1 and x <= 1.
Expected<SXElem> Recognition::on_surfaces_only(const Condition& condition, bool elsewhere) {
  const double truth = elsewhere ? 1.0 : 0.0;
  for (const auto& comparison : comparisons_of(condition)) {
    const auto difference = difference_of(comparison);
    if (!difference) return difference;
    const auto chosen = selection(*difference, comparison.name, std::nullopt);
    if (!chosen) return tl::unexpected(chosen.error());
    if (chosen->kind != Selection::Kind::alpha || functions_[at(chosen->function.function)].discrete) continue;
    const SXElem& alpha = functions_[at(chosen->function.function)].alpha;
    return marked(truth + (graph.marked(alpha) - alpha), condition);
  }
  return SXElem(truth);
}

/// @param difference, here  as written, and at the instant
Expected<SXElem> Recognition::comparison_at_instant(const Comparison& comparison, const SXElem& difference,
                                                    const SXElem& here) {
  const bool at_zero = comparison.at_equality == AtEquality::is_true;
  const auto chosen = selection(difference, comparison.name, at_zero ? 1.0 : 0.0);
  if (!chosen) return tl::unexpected(chosen.error());
  // What is at its surface is known of a function of its own, not of one with other conditions in it.
  if (chosen->kind != Selection::Kind::alpha || here.get() != difference.get()) return beyond(0.0, here, at_zero);
  const SXElem& alpha = functions_[at(chosen->function.function)].alpha;
  return beyond(at_zero ? 0.0 : 1.0, chosen->function.orientation > 0 ? alpha : 1.0 - alpha, !at_zero);
}

/// The truth at the instant of a condition whose differences are known there.
Expected<SXElem> Recognition::truth_at_instant(const Condition& condition, const KnownExpressions& known) {
  std::vector<SXElem> truths;
  for (const auto& comparison : comparisons_of(condition)) {
    const auto difference = difference_of(comparison);
    if (!difference) return difference;
    auto truth = comparison_at_instant(comparison, *difference, known.at(difference->get()));
    if (!truth) return truth;
    truths.push_back(std::move(*truth));
  }
  auto next = truths.cbegin();
  return truth_of(condition, next);
}

Expected<SXElem> Recognition::at_instant(const SXElem& e) {
  KnownExpressions known;
  std::vector<SXElem> open{e};
  while (!open.empty()) {
    const SXElem current = open.back();
    std::vector<SXElem> needed;
    const auto mark = conditions_.find(current.get());
    if (mark != conditions_.end()) {
      for (const auto& comparison : comparisons_of(mark->second)) {
        const auto difference = difference_of(comparison);
        if (!difference) return difference;
        needed.push_back(*difference);
      }
    } else if (!current.is_constant() && !current.is_symbolic()) {
      for (casadi_int i = 0; i < current.n_dep(); ++i) needed.push_back(current.dep(i));
    }
    const auto before = open.size();
    for (const auto& one : needed) {
      if (!known.contains(one.get())) open.push_back(one);
    }
    if (open.size() > before) continue;
    open.pop_back();
    if (known.contains(current.get())) continue;
    if (mark != conditions_.end()) {
      auto truth = truth_at_instant(Condition(mark->second), known);
      if (!truth) return truth;
      known.emplace(current.get(), std::move(*truth));
    } else {
      known.emplace(current.get(), with_operands(current, known));
    }
  }
  return known.at(e.get());
}

}  // namespace saltus::model
