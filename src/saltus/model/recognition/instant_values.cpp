// Values at an instant, as a jump sets them: comparisons are what their operators say of equality.
#include <algorithm>
#include <map>

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

SXElem Recognition::marked(const SXElem& value, const WrittenTerm& term) {
  const KindSet inside = graph.tape()[graph.node(term.argument)].written;
  constexpr KindSet changed = kind_bit(VariableKind::alpha) | kind_bit(VariableKind::cell);
  if ((inside & changed) == 0 || value.is_constant()) return value;
  const SXElem mark = graph.marked(value);
  terms_.insert_or_assign(mark.get(), term);
  return mark;
}

/// Goes through an expression from its leaves on: what is inside of a term comes first.
class Recognition::AtInstant {
 public:
  AtInstant(Recognition& recognition, const Instant& instant) : its_(recognition), instant_(instant) {
    for (const auto& cell : its_.graph.cells()) {
      if (cell.table == its_.integers_) whole_parts_.emplace(cell.symbols.front().get(), cell.argument);
    }
    for (const auto& function : its_.functions_) functions_.emplace(function.alpha.get(), functions_.size());
  }

  [[nodiscard]] Expected<SXElem> value_there(const SXElem& e) {
    std::vector<SXElem> open{e};
    while (!open.empty()) {
      const SXElem current = open.back();
      const auto needed = parts(current);
      if (!needed) return tl::unexpected(needed.error());
      const auto before = open.size();
      for (const auto& one : *needed) {
        if (!known_.contains(one.get())) open.push_back(one);
      }
      if (open.size() > before) continue;
      open.pop_back();
      if (known_.contains(current.get())) continue;
      auto here = from_parts(current);
      if (!here) return here;
      known_.emplace(current.get(), std::move(*here));
    }
    return here(e);
  }

 private:
  [[nodiscard]] const SXElem& here(const SXElem& e) const { return known_.at(e.get()); }
  [[nodiscard]] bool is_as_written(const SXElem& e) const { return here(e).get() == e.get(); }

  [[nodiscard]] bool may_slide(const SXElem& e) const {
    const auto inside = its_.alphas_in(its_.graph.node(e));
    return std::any_of(inside.begin(), inside.end(), [this](int j) { return holds(instant_.moving, j); });
  }
  /// Functions that were met later are in no list.
  [[nodiscard]] static bool holds(const std::vector<bool>& list, int function) {
    return at(function) < list.size() && list[at(function)];
  }

  [[nodiscard]] Expected<std::vector<SXElem>> parts(const SXElem& e) {
    std::vector<SXElem> needed;
    if (const auto mark = its_.conditions_.find(e.get()); mark != its_.conditions_.end()) {
      for (const auto& comparison : comparisons_of(mark->second)) {
        const auto difference = its_.difference_of(comparison);
        if (!difference) return tl::unexpected(difference.error());
        needed.push_back(*difference);
      }
      return needed;
    }
    if (const auto cell = whole_parts_.find(e.get()); cell != whole_parts_.end()) return std::vector{cell->second};
    if (const auto j = functions_.find(e.get()); j != functions_.end()) {
      if (!is_known(j->second)) needed.push_back(its_.functions_[j->second].psi);
      return needed;
    }
    if (const auto term = its_.terms_.find(e.get()); term != its_.terms_.end()) needed = term->second.parts();
    for (casadi_int i = 0; !e.is_constant() && !e.is_symbolic() && i < e.n_dep(); ++i) needed.push_back(e.dep(i));
    return needed;
  }

  [[nodiscard]] Expected<SXElem> from_parts(const SXElem& e) {
    if (const auto mark = its_.conditions_.find(e.get()); mark != its_.conditions_.end()) {
      return condition_there(Condition(mark->second));
    }
    if (const auto cell = whole_parts_.find(e.get()); cell != whole_parts_.end())
      return whole_part_there(here(cell->second));
    if (const auto j = functions_.find(e.get()); j != functions_.end()) {
      return is_known(j->second) ? e : known_or(j->second, e, step_there(here(its_.functions_[j->second].psi)));
    }
    const auto term = its_.terms_.find(e.get());
    if (term == its_.terms_.end()) return with_operands(e, known_);
    const auto& [kind, argument, a, b] = term->second;
    if (is_as_written(argument) && may_slide(argument)) return here(e.dep(0));  // the mixture that moves the states
    const SXElem& value = here(argument);
    if (kind == WrittenTerm::Kind::whole_part) return whole_part_there(value);
    return kind == WrittenTerm::Kind::step ? step_there(value) : either(beyond(0.0, value, false), here(a), here(b));
  }

  [[nodiscard]] static SXElem either(const SXElem& first, const SXElem& a, const SXElem& b) {
    return SXElem::binary(casadi::OP_IF_ELSE_ZERO, first, a) + SXElem::binary(casadi::OP_IF_ELSE_ZERO, 1.0 - first, b);
  }
  [[nodiscard]] SXElem step_there(const SXElem& value) const {
    return 0.5 * (above(value, false) + above(value, true));
  }

  /// The selections inside of a function, also by inputs.
  [[nodiscard]] const std::vector<SXElem>& inside(std::size_t function) {
    const auto [found, is_new] = inside_.try_emplace(function);
    if (!is_new) return found->second;
    const Tape& tape = its_.graph.tape();
    std::vector<int> inputs;
    std::vector<int> roots{its_.functions_[function].psi_node};
    for (const auto* from : {&roots, &inputs}) {
      for (const int leaf : tape.cone(*from, Links::through_alpha)) {
        if (tape[leaf].psi >= 0) found->second.push_back(its_.graph.expression(leaf));
        if (tape[leaf].variable < 0 || tape[leaf].operation == cell_operation || from == &inputs) continue;
        const auto& variable = tape.variables()[at(tape[leaf].variable)];
        if (variable.kind == VariableKind::control) inputs.push_back(instant_.inputs[at(variable.index)]);
      }
    }
    return found->second;
  }
  /// Whether a run knows the selection of a function whatever is at zero.
  [[nodiscard]] bool is_known(std::size_t function) {
    return holds(instant_.followed, static_cast<int>(function)) && inside(function).empty();
  }
  /// What a run knows of a function, where it follows it and nothing inside of it is at zero; else what its value says.
  [[nodiscard]] SXElem known_or(std::size_t function, const SXElem& known, const SXElem& by_value) {
    if (!holds(instant_.followed, static_cast<int>(function))) return by_value;
    if (inside(function).empty()) return known;
    SXElem open = 0.0;
    for (const SXElem& alpha : inside(function)) open += alpha * (1.0 - alpha);
    return either(beyond(0.0, open, false), by_value, known);
  }

  /// Whether a value is above 0, or is 0 but for its rounding and that counts.
  [[nodiscard]] SXElem above(const SXElem& value, bool at_zero) const {
    const auto still = its_.changes_by_jumps_only(value);  // compared exactly
    const SXElem rounding = still && *still ? SXElem(0.0) : instant_.rounding(value);
    return beyond(at_zero ? -rounding : rounding, value, at_zero);
  }
  [[nodiscard]] SXElem whole_part_there(const SXElem& value) const {
    return SXElem::unary(casadi::OP_FLOOR, value + instant_.rounding(value));
  }

  [[nodiscard]] Expected<SXElem> comparison_there(const Comparison& comparison, const SXElem& difference) {
    const bool at_zero = comparison.at_equality == AtEquality::is_true;
    const auto chosen = its_.selection(difference, comparison.name, at_zero ? 1.0 : 0.0);
    if (!chosen) return tl::unexpected(chosen.error());
    const SXElem by_value = above(here(difference), at_zero);
    if (chosen->kind != Selection::Kind::alpha) return by_value;
    const auto& [function, orientation] = chosen->function;
    const SXElem& alpha = its_.functions_[at(function)].alpha;
    return known_or(at(function), beyond(at_zero ? 0.0 : 1.0, orientation > 0 ? alpha : 1.0 - alpha, !at_zero),
                    by_value);
  }

  [[nodiscard]] Expected<SXElem> condition_there(const Condition& condition) {
    std::vector<SXElem> truths;
    for (const auto& comparison : comparisons_of(condition)) {
      const auto difference = its_.difference_of(comparison);
      if (!difference) return difference;
      auto holds = comparison_there(comparison, *difference);
      if (!holds) return holds;
      truths.push_back(std::move(*holds));
    }
    auto next = truths.cbegin();
    return truth_of(condition, next);
  }

  Recognition& its_;
  const Instant& instant_;
  KnownExpressions whole_parts_;                            ///< arguments, by the symbols of their cells
  std::unordered_map<const void*, std::size_t> functions_;  ///< by their selections
  std::map<std::size_t, std::vector<SXElem>> inside_;
  KnownExpressions known_;
};

std::optional<Error> Recognition::put_at_instant(const std::vector<casadi::SX*>& all, const Instant& instant) {
  AtInstant at_instant(*this, instant);
  for (auto* expressions : all) {
    for (SXElem& e : expressions->nonzeros()) {
      const auto value = at_instant.value_there(e);
      if (!value) return value.error();
      e = *value;
    }
  }
  return std::nullopt;
}

}  // namespace saltus::model
