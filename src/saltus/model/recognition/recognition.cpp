#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {
namespace {

bool holds(double difference, AtEquality at_equality) {
  return difference > 0.0 || (difference == 0.0 && at_equality == AtEquality::is_true);
}

std::string shown(const SXElem& e, const std::string& name) { return name.empty() ? casadi::SX(e).get_str() : name; }

bool is_discrete(KindSet reached) { return (reached & moving_kinds) == 0 && (reached & jumping_kinds) != 0; }

std::string quoted(const SXElem& e, const std::string& name) { return "'" + shown(e, name) + "'"; }

}  // namespace

Error chain_too_long(const std::string& name) {
  return {ErrorCode::invalid_model,
          "the nonsmooth terms nested in '" + name + "' unfold into more than " + std::to_string(branch_limit) +
              " branches",
          "nest fewer of them, or make an intermediate quantity a state",
          {},
          {}};
}

std::vector<int> Recognition::alphas_in(int node) const {
  std::vector<int> indices;
  const Tape& tape = graph.tape();
  if ((tape[node].written & kind_bit(VariableKind::alpha)) == 0) return indices;
  for (const int leaf : tape.cone(std::span(&node, 1), Links::written)) {
    if (tape[leaf].psi < 0) continue;
    indices.push_back(tape.variables()[at(tape[leaf].variable)].index);
  }
  return indices;  // ascending, as the nodes of alphas are
}

std::vector<bool> Recognition::functions_below(const std::vector<int>& roots) const {
  std::vector<bool> below(functions_.size(), false);
  for (const int leaf : graph.tape().cone(roots, Links::through_alpha)) {
    if (graph.tape()[leaf].psi >= 0) below[at(graph.tape().variables()[at(graph.tape()[leaf].variable)].index)] = true;
  }
  return below;
}

/// A function that is the same, on its surface, too: discrete functions with another value at 0 are others.
std::optional<SharedFunction> Recognition::find(int psi_node, std::optional<double> at_zero) {
  const auto value_of = [&](const SharedFunction& found) { return found.orientation > 0 ? *at_zero : 1.0 - *at_zero; };
  const auto found = index_.find(graph.tape(), psi_node, [&](const SharedFunction& candidate) {
    const auto& met = functions_[at(candidate.function)];
    return !met.discrete || !at_zero || !met.alpha_at_zero || *met.alpha_at_zero == value_of(candidate);
  });
  if (!found) return found;
  auto& met = functions_[at(found->function)];
  if (met.psi_node != psi_node) {
    note({.kind = Decision::Kind::multiple, .node = met.psi_node, .other = psi_node}, [&] {
      return fmt::format("'{}' and {} are one switching function", met.name, quoted(graph.expression(psi_node), ""));
    });
  }
  if (at_zero) {
    const bool on_discrete = (graph.tape()[met.psi_node].reached & kind_bit(VariableKind::discrete)) != 0;
    if (on_discrete && !met.alpha_at_zero) met.alpha_at_zero = value_of(*found);
  }
  return found;
}

int Recognition::append(const std::string& name, const SXElem& psi, int psi_node, std::optional<double> at_zero) {
  const auto index = static_cast<int>(functions_.size());
  MetFunction met{shown(psi, name), psi, psi_node, SXElem(0.0), 0, false};
  const KindSet reached = graph.tape()[psi_node].reached;
  met.discrete = is_discrete(reached);
  if ((reached & jumping_kinds) != 0) met.alpha_at_zero = at_zero;
  if (met.discrete) {
    const bool taken =
        std::any_of(functions_.begin(), functions_.end(), [&](const auto& other) { return other.name == met.name; });
    if (taken) met.name = at_zero == 0.5 ? "step(" + met.name + ")" : met.name + (at_zero == 1.0 ? ">=0" : ">0");
  }
  met.alpha = graph.alpha_symbol("alpha(" + met.name + ")", index, psi_node);
  met.alpha_node = graph.node(met.alpha);
  functions_.push_back(std::move(met));
  index_.insert(graph.tape(), psi_node, index);
  return index;
}

/// e depends on alphas only: its step is a function of them (rewriting step(E[step(s)]) into step(s) step(E[1]) + …).
Expected<Recognition::Selection> Recognition::corner_selection(int node, const std::vector<int>& literals) {
  Selection result{.kind = Selection::Kind::polynomial, .literals = literals};
  const Tape& tape = graph.tape();
  const auto cone = tape.cone(std::span(&node, 1), Links::written);
  Point point = blank_point(tape);
  TapeValues values;
  std::vector<std::map<int, double>> corners;
  for (std::size_t corner = 0; corner < (std::size_t{1} << literals.size()); ++corner) {
    corners.emplace_back();
    for (std::size_t k = 0; k < literals.size(); ++k) {
      const int leaf = functions_[at(literals[k])].alpha_node;
      point[at(tape[leaf].variable)] = corners.back()[leaf] = (corner >> k & 1U) != 0 ? 1.0 : 0.0;
    }
    evaluate(tape, cone, point, values);
    result.corners.push_back(values.value[at(node)]);
  }
  for (const auto& fixed : corners) {
    const SXElem value = graph.with_alphas(node, fixed);
    note({.kind = Decision::Kind::sign, .node = graph.node(value)}, [&] { return quoted(value, ""); });
  }
  return result;
}

Expected<Recognition::Selection> Recognition::selection(const SXElem& e, const std::string& name,
                                                        std::optional<double> at_zero) {
  const auto node = graph.add(e);
  if (!node) return tl::unexpected(node.error());
  const Tape& tape = graph.tape();
  // What is a switching function already is no constant.
  const auto constant = index_.has(*node) ? std::nullopt : constant_value(tape, *node);
  if (constant) {
    note({.kind = Decision::Kind::sign, .node = *node}, [&] { return quoted(e, name); });
    return Selection{.constant = *constant};
  }
  const auto known = find(*node, at_zero);
  if (known) return Selection{.kind = Selection::Kind::alpha, .function = *known};
  const auto literals = alphas_in(*node);
  if (!literals.empty() && count_branches(tape, *node, branch_limit) > branch_limit) {
    return tl::unexpected(chain_too_long(shown(e, name)));
  }
  // A discrete function takes its value at 0, too, which corners do not know: sign(sign(n)) >= 0.
  const bool still = (tape[*node].reached & moving_kinds) == 0;
  if (!still && (tape[*node].written & changing_kinds) == 0 && literals.size() <= 6) {
    return corner_selection(*node, literals);
  }
  return Selection{.kind = Selection::Kind::alpha, .function = {append(name, e, *node, at_zero), +1}};
}

SXElem Recognition::value(const Selection& selection) {
  switch (selection.kind) {
    case Selection::Kind::constant:
      return SXElem(step_value(selection.constant));
    case Selection::Kind::alpha: {
      const SXElem& alpha = functions_[at(selection.function.function)].alpha;
      return selection.function.orientation > 0 ? alpha : 1.0 - alpha;
    }
    case Selection::Kind::polynomial:
      break;
  }
  std::vector<SXElem> alphas;
  for (const int literal : selection.literals) alphas.push_back(functions_[at(literal)].alpha);
  std::vector<double> steps;
  for (const double corner : selection.corners) steps.push_back(step_value(corner));
  return graph.interpolation(alphas, steps);
}

Expected<SXElem> Recognition::surface(const SXElem& e, const std::string& name) {
  return selection(e, name, 0.5).map([&](const Selection& s) {
    return s.kind == Selection::Kind::polynomial ? marked(value(s), {WrittenTerm::Kind::step, e}) : value(s);
  });
}

Expected<SXElem> Recognition::step(const SXElem& e, const std::string& name) {
  return blended(e, name, [this](const SXElem& one, const std::string& its_name) { return surface(one, its_name); });
}

Expected<SXElem> Recognition::sign(const SXElem& e, const std::string& name) {
  return step(e, name).map([](const SXElem& alpha) { return 2.0 * alpha - 1.0; });
}

/// a where the difference is positive, b where it is negative; a on a difference that is always 0.
Expected<SXElem> Recognition::choose(const SXElem& difference, const std::string& name, const SXElem& a,
                                     const SXElem& b) {
  // Numbers first: a branch that is refused should say so, and identical branches need no switch at all.
  for (const SXElem* branch : {&a, &b}) {
    if (const auto added = graph.add(*branch); !added) return tl::unexpected(added.error());
  }
  if (graph.node(a) == graph.node(b)) return a;
  return blended(difference, name,
                 [&](const SXElem& one, const std::string& its_name) -> Expected<SXElem> {
                   const auto chosen = selection(one, its_name, std::nullopt);
                   if (!chosen) return tl::unexpected(chosen.error());
                   if (chosen->kind == Selection::Kind::constant) return chosen->constant < 0.0 ? b : a;
                   if (chosen->kind == Selection::Kind::alpha && chosen->function.orientation < 0) {
                     return graph.blend(functions_[at(chosen->function.function)].alpha, b, a);
                   }
                   return graph.blend(value(*chosen), a, b);
                 })
      .map([&](const SXElem& value) {
        return marked(value, {WrittenTerm::Kind::choice, difference, a, b});
      });
}

Expected<SXElem> Recognition::abs(const SXElem& e, const std::string& name) { return choose(e, name, e, -e); }

Expected<SXElem> Recognition::max(const SXElem& a, const SXElem& b, const std::string& name) {
  return choose(a - b, name, a, b);
}

Expected<SXElem> Recognition::min(const SXElem& a, const SXElem& b, const std::string& name) {
  return choose(a - b, name, b, a);
}

Expected<Truth> Recognition::comparison_truth(TruthDiagram& diagram, const Comparison& comparison) {
  const auto difference = difference_of(comparison);
  if (!difference) return tl::unexpected(difference.error());
  const auto both = both_values(*difference);
  if (!both) return tl::unexpected(both.error());
  if (*both) return truth_at_both(diagram, comparison, **both);
  const auto chosen =
      selection(*difference, comparison.name, comparison.at_equality == AtEquality::is_true ? 1.0 : 0.0);
  if (!chosen) return tl::unexpected(chosen.error());
  switch (chosen->kind) {
    case Selection::Kind::constant:
      return holds(chosen->constant, comparison.at_equality) ? TruthDiagram::constant_true()
                                                             : TruthDiagram::constant_false();
    case Selection::Kind::alpha: {
      const Truth literal = diagram.literal(chosen->function.function);
      return chosen->function.orientation > 0 ? literal : diagram.negation(literal);
    }
    case Selection::Kind::polynomial:
      break;
  }
  std::vector<bool> entries;
  for (const double corner : chosen->corners) entries.push_back(holds(corner, comparison.at_equality));
  return diagram.table(chosen->literals, entries);
}

Expected<Truth> Recognition::truth(TruthDiagram& diagram, const Condition& condition) {
  switch (condition.kind()) {
    case Condition::Kind::constant:
      return condition.truth() > 0.0 ? 1 : 0;
    case Condition::Kind::comparison:
      return comparison_truth(diagram, condition.comparison());
    case Condition::Kind::negation:
      return truth(diagram, condition.left()).map([&](Truth a) { return diagram.negation(a); });
    case Condition::Kind::conjunction:
    case Condition::Kind::disjunction:
      break;
  }
  const auto a = truth(diagram, condition.left());
  if (!a) return a;
  const auto b = truth(diagram, condition.right());
  if (!b) return b;
  return condition.kind() == Condition::Kind::conjunction ? diagram.conjunction(*a, *b) : diagram.disjunction(*a, *b);
}

Expected<SXElem> Recognition::select(const Condition& condition, const SXElem& a, const SXElem& b) {
  for (const SXElem* branch : {&a, &b}) {
    if (const auto added = graph.add(*branch); !added) return tl::unexpected(added.error());
  }
  TruthDiagram diagram;
  const auto holds_where = truth(diagram, condition);
  if (!holds_where) return tl::unexpected(holds_where.error());
  if (diagram.overflowed()) return tl::unexpected(chain_too_long("the condition of an if"));
  std::vector<SXElem> literals;
  for (const auto& function : functions_) literals.push_back(function.alpha);
  if (*holds_where <= 1) {
    return on_surfaces_only(condition, *holds_where == TruthDiagram::constant_true()).map([&](const SXElem& truth) {
      return graph.blend(truth, a, b);
    });
  }
  // A single literal the other way round exchanges the branches rather than computing with 1 - alpha.
  const auto& top = diagram[*holds_where];
  if (top.low == 1 && top.high == 0) return graph.blend(marked(literals[at(top.literal)], !condition), b, a);
  return graph.blend(marked(graph.polynomial(diagram, *holds_where, literals), condition), a, b);
}

Expected<DeclaredFunction> Recognition::declare(const std::string& name, const SXElem& psi) {
  const auto node = graph.add(psi);
  if (!node) return tl::unexpected(node.error());
  const Tape& tape = graph.tape();
  if (constant_value(tape, *node)) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                "the switching function '" + name + "' is constant: it never changes its sign",
                                "let it depend on a state or on t, or remove it",
                                {},
                                {}});
  }
  if ((tape[*node].written & kind_bit(VariableKind::alpha)) != 0 &&
      count_branches(tape, *node, branch_limit) > branch_limit) {
    return tl::unexpected(chain_too_long(name));
  }
  const auto known = find(*node, std::nullopt);
  if (!known) {
    const int index = append(name, psi, *node, std::nullopt);
    functions_.back().named = true;
    return DeclaredFunction{name, {index, +1}, ""};
  }
  MetFunction& met = functions_[at(known->function)];
  if (met.named) return DeclaredFunction{name, *known, met.name};
  // An unnamed multiple came first (inside another declared function): it takes over name and scaling, unless that
  // would break the order of nesting.
  const auto inner = alphas_in(*node);
  if (inner.empty() || inner.back() < known->function) {
    met.psi = known->orientation > 0 ? psi : -psi;
    met.psi_node = graph.node(met.psi);
  }
  met.name = name;
  met.named = true;
  return DeclaredFunction{name, *known, ""};
}

Expected<SXElem> Recognition::difference_of(const Comparison& comparison) {
  const auto difference = scalar(comparison.difference);
  if (!difference) {
    return tl::unexpected(Error{
        ErrorCode::invalid_model, "a comparison of vectors or matrices", "compare their entries one by one", {}, {}});
  }
  const auto still = changes_by_jumps_only(*difference);
  if (!still) return tl::unexpected(still.error());
  if (*still || comparison.sides == Sides::any) return *difference;
  return tl::unexpected(Error{ErrorCode::invalid_model,
                              fmt::format("equal and not_equal compare constants, parameters and discrete states only; "
                                          "'{}' moves",
                                          shown(*difference, comparison.name)),
                              "use less, less_equal, greater or greater_equal; or declare discrete_state()",
                              {},
                              {}});
}

void Recognition::restate_as_state(const SXElem& symbol, int index) {
  graph.restate_as_state(symbol, index);
  for (auto& met : functions_) {
    const KindSet reached = graph.tape()[met.psi_node].reached;
    met.discrete = is_discrete(reached);
    if ((reached & jumping_kinds) == 0) met.alpha_at_zero.reset();
  }
}

void Recognition::note(Decision decision, FunctionRef<std::string()> text) {
  if (!has_parameters(graph.tape(), decision)) return;
  decision.text = text();
  if (!known_decisions_.emplace(decision.kind, decision.node, decision.other, decision.text).second) return;
  decisions_.push_back(decided(graph.tape(), std::move(decision)));
}

std::optional<double> Recognition::parameter_value(const SXElem& expression) {
  const auto node = graph.add(expression);
  if (!node || (graph.tape()[*node].reached & ~kind_bit(VariableKind::parameter)) != 0) return std::nullopt;
  return constant_value(graph.tape(), *node);
}

}  // namespace saltus::model
