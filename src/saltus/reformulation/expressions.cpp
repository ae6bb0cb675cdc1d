#include <unordered_set>

#include <casadi/core/sx_elem.hpp>

#include "saltus/reformulation/expressions_internal.hpp"

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/contracts.hpp"
#include "saltus/model/graph/finite_operations.hpp"

namespace saltus::reformulation {
namespace {

bool is_leaf(const SXElem& expression) { return expression.is_constant() || expression.is_symbolic(); }

/// Calls visit(node) for every node below `root` once, operands before what is made of them. An explicit stack: a sum
/// of many terms is as many levels deep.
template <class Done, class Visit>
void visit_from_below(const SXElem& root, Done&& is_done, Visit&& visit) {
  std::vector<SXElem> open{root};
  while (!open.empty()) {
    const SXElem current = open.back();
    if (is_done(current)) {
      open.pop_back();
      continue;
    }
    bool ready = true;
    for (casadi_int i = 0; !is_leaf(current) && i < current.n_dep(); ++i) {
      const SXElem operand = current.dep(i);
      if (is_done(operand)) continue;
      open.push_back(operand);
      ready = false;
    }
    if (!ready) continue;
    visit(current);
    open.pop_back();
  }
}

bool stays_finite(const SXElem& expression) {
  if (expression.op() == casadi::OP_DIV) return expression.dep(1).is_constant();
  return model::stays_finite(static_cast<int>(expression.op()));
}

}  // namespace

void Replacement::set(const SXElem& symbol, const SXElem& value) {
  symbols_.push_back(symbol);
  values_.insert_or_assign(symbol.get(), value);
}

void Replacement::set(const SX& symbols, const SX& values) {
  const auto from = entries(symbols), to = entries(values);
  SALTUS_ASSERT(from.size() == to.size());
  for (std::size_t i = 0; i < from.size(); ++i) set(from[i], to[i]);
}

SXElem Replacement::of(const SXElem& expression, Known& known) const {
  const auto rebuild = [&](const SXElem& e) {
    if (is_leaf(e)) return e;
    const SXElem left = known.at(e.dep(0).get());
    if (e.n_dep() == 1) return SXElem::unary(static_cast<casadi_int>(e.op()), left);
    if (e.op() == casadi::OP_IF_ELSE_ZERO && left.is_one()) return known.at(e.dep(1).get());
    return SXElem::binary(static_cast<casadi_int>(e.op()), left, known.at(e.dep(1).get()));
  };
  visit_from_below(
      expression, [&](const SXElem& e) { return known.contains(e.get()); },
      [&](const SXElem& e) { known.emplace(e.get(), rebuild(e)); });
  return known.at(expression.get());
}

SXElem Replacement::of(const SXElem& expression) const {
  if (values_.empty()) return expression;
  Known known = values_;
  return of(expression, known);
}

SX Replacement::of(const SX& expression) const {
  if (values_.empty() || expression.numel() == 0) return expression;
  Known known = values_;
  std::vector<SXElem> rebuilt;
  const auto old = entries(expression);
  for (const SXElem& e : old) rebuilt.push_back(of(e, known));
  return column(rebuilt);
}

std::vector<SXElem> symbols_in(const SX& expression) {
  std::vector<SXElem> found;
  std::unordered_set<const void*> seen;
  for (const SXElem& e : expression.nonzeros()) {
    visit_from_below(
        e, [&](const SXElem& node) { return seen.contains(node.get()); },
        [&](const SXElem& node) {
          seen.insert(node.get());
          if (node.is_symbolic()) found.push_back(node);
        });
  }
  return found;
}

namespace {

/// The parts of an expression, by address, in which one of the symbols occurs.
std::unordered_set<const void*> nodes_with(const SXElem& expression, const std::unordered_set<const void*>& symbols) {
  std::unordered_set<const void*> seen, found;
  visit_from_below(
      expression, [&](const SXElem& node) { return seen.contains(node.get()); },
      [&](const SXElem& node) {
        seen.insert(node.get());
        bool has = symbols.contains(node.get());
        for (casadi_int i = 0; !is_leaf(node) && i < node.n_dep(); ++i) has = has || found.contains(node.dep(i).get());
        if (has) found.insert(node.get());
      });
  return found;
}

class Terms {
 public:
  Terms(const SXElem& expression, const std::unordered_set<const void*>& symbols)
      : with_symbols_(nodes_with(expression, symbols)) {}

  std::vector<SXElem> of(const SXElem& e) {
    if (!has_symbols(e)) return {e};
    const auto operation = static_cast<casadi_int>(e.op());
    switch (operation) {
      case casadi::OP_ADD:
        return joined(of(e.dep(0)), of(e.dep(1)));
      case casadi::OP_SUB:
        return joined(of(e.dep(0)), each(of(e.dep(1)), [](const SXElem& term) { return -term; }));
      case casadi::OP_NEG:
      case casadi::OP_TWICE:
        return each(of(e.dep(0)), [operation](const SXElem& term) { return SXElem::unary(operation, term); });
      case casadi::OP_DIV:
        if (has_symbols(e.dep(1))) return {e};
        return each(of(e.dep(0)), [&](const SXElem& term) { return term / e.dep(1); });
      case casadi::OP_MUL:
        if (!has_symbols(e.dep(1))) return each(of(e.dep(0)), [&](const SXElem& term) { return term * e.dep(1); });
        if (!has_symbols(e.dep(0))) return each(of(e.dep(1)), [&](const SXElem& term) { return e.dep(0) * term; });
        return {e};
      default:
        return {e};
    }
  }

 private:
  using List = std::vector<SXElem>;

  [[nodiscard]] bool has_symbols(const SXElem& e) const { return with_symbols_.contains(e.get()); }
  static List joined(List a, const List& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  template <class Change>
  static List each(List terms, Change&& change) {
    for (SXElem& term : terms) term = change(term);
    return terms;
  }

  std::unordered_set<const void*> with_symbols_;
};

}  // namespace

std::vector<SXElem> additive_terms(const SXElem& expression, const std::unordered_set<const void*>& symbols) {
  return Terms(expression, symbols).of(expression);
}

bool may_be_nonfinite(const SXElem& expression, const SX& constants) {
  std::unordered_set<const void*> fixed;
  for (const SXElem& symbol : constants.nonzeros()) fixed.insert(symbol.get());
  std::unordered_map<const void*, bool> moves;  // nodes seen
  bool found = false;
  visit_from_below(
      expression, [&](const SXElem& e) { return moves.contains(e.get()); },
      [&](const SXElem& e) {
        if (is_leaf(e)) {
          moves[e.get()] = e.is_symbolic() && !fixed.contains(e.get());
          return;
        }
        bool moving = false;
        for (casadi_int i = 0; i < e.n_dep(); ++i) moving = moving || moves.at(e.dep(i).get());
        const bool fixed_divisor = e.op() == casadi::OP_DIV && !moves.at(e.dep(1).get());
        found = found || (moving && !stays_finite(e) && !fixed_divisor);
        moves[e.get()] = moving;
      });
  return found;
}

SXElem weighted(const SXElem& weight, const SXElem& branch, const SX& constants) {
  if (weight.is_zero() || branch.is_zero()) return 0.0;
  if (weight.is_one()) return branch;
  if (!may_be_nonfinite(branch, constants)) return weight * branch;
  const SXElem taken = SXElem::binary(casadi::OP_NE, weight, SXElem(0.0));
  return SXElem::binary(casadi::OP_IF_ELSE_ZERO, taken, weight * branch);
}

SXElem entry(const SX& scalar) { return entries(scalar).front(); }

SX column(const std::vector<SXElem>& entries) { return SX(entries); }

std::vector<SXElem> entries(const SX& column) {
  return column.numel() == 0 ? std::vector<SXElem>{} : SX::densify(column).nonzeros();
}

}  // namespace saltus::reformulation
