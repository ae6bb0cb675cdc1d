// CasADi expressions and their numbers on the tape; everything that builds an expression out of selections.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/error.hpp"
#include "saltus/model/graph/tape_internal.hpp"
#include "saltus/model/graph/truth_internal.hpp"

namespace saltus::model {

using casadi::SXElem;

/// Holds a place where a table, or floor, is applied: one symbol per constant of the cell its argument lies in.
struct CellUse {
  std::string name;  ///< "floor(t/T)"
  SXElem argument;
  std::vector<SXElem> symbols;
  std::vector<int> nodes;  ///< of the symbols
  std::shared_ptr<const CellTable> table;
};

/// Holds what expressions have become, by their addresses.
using KnownExpressions = std::unordered_map<const void*, SXElem>;

/// Returns an expression with what its operands have become; itself where they are what they were.
[[nodiscard]] SXElem with_operands(const SXElem& expression, const KnownExpressions& known);

class SxGraph {
 public:
  [[nodiscard]] const Tape& tape() const { return tape_; }
  void set_value(int variable, double value) { tape_.set_value(variable, value); }
  void restate_as_state(const SXElem& symbol, int index) {
    tape_.restate_as_state(tape_[node(symbol)].variable, index);
  }

  SXElem symbol(const std::string& name, const Variable& variable);
  SXElem alpha_symbol(const std::string& name, int index, int psi);

  /// Adds the constants of the cell in which `argument` (added before, free of alphas) lies; the same ones for the same
  /// argument and table.
  const CellUse& cell(const SXElem& argument, const std::shared_ptr<const CellTable>& table, const std::string& name);
  /// Returns cells in the order they were met, hence arguments of arguments first.
  [[nodiscard]] const std::vector<CellUse>& cells() const { return cells_; }

  /// Returns the number of an expression made of this graph's symbols.
  /// @return the node, or invalid_model for a foreign symbol, a function call or a nonsmooth CasADi operation: those
  ///         would pass for smooth ones; the remedy names the builder function to use.
  [[nodiscard]] Expected<int> add(const SXElem& expression);

  /// Returns a node's number for an expression that was made here.
  [[nodiscard]] int node(const SXElem& expression);
  /// Returns a copy: what is made with it may add nodes, which moves those that are there.
  [[nodiscard]] SXElem expression(int node) const { return expressions_[at(node)]; }

  /// Returns an expression of its own with the value and the node of one that depends on alphas.
  [[nodiscard]] SXElem marked(const SXElem& expression);
  /// Takes the marks out of expressions. What they share stays shared as long as `known` is the same.
  void drop_marks(casadi::SX& expressions, KnownExpressions& known) const;

  /// Returns the expression with some alphas (by node) fixed.
  [[nodiscard]] SXElem with_alphas(int node, const std::map<int, double>& fixed);

  /// Returns c a + (1 - c) b for c in [0, 1]. Exactly a where c is 1 and b where c is 0, also if the other is NaN or
  /// infinite; a branch that cannot be is multiplied plainly, so that derivatives with respect to c are right at c = 0
  /// and 1, too.
  [[nodiscard]] SXElem blend(const SXElem& c, const SXElem& a, const SXElem& b);

  /// Returns weight * branch, and 0 where the weight is 0 whatever the branch is; the weight is made of alphas.
  [[nodiscard]] SXElem weighted(const SXElem& weight, const SXElem& branch);

  /// Returns the multi-affine polynomial of a condition in the selections of its literals.
  [[nodiscard]] SXElem polynomial(const TruthDiagram& diagram, Truth truth, const std::vector<SXElem>& literals);

  /// Returns the multi-affine interpolation of values at the corners; entry i has bit k of i as the value of alphas[k].
  [[nodiscard]] SXElem interpolation(const std::vector<SXElem>& alphas, const std::vector<double>& values);

 private:
  [[nodiscard]] Expected<int> add_one(const SXElem& expression);
  int remember(const SXElem& expression, int node);

  Tape tape_;
  std::unordered_map<const void*, int> numbers_;
  std::vector<SXElem> keep_alive_;   ///< the addresses in numbers_ stay theirs
  std::vector<SXElem> expressions_;  ///< by node
  std::vector<CellUse> cells_;
  bool has_marks_ = false;
};

/// Returns the only entry of a scalar; nothing for other shapes.
[[nodiscard]] std::optional<SXElem> scalar(const casadi::SX& expression);

/// Returns a dense column.
[[nodiscard]] casadi::SX column(const std::vector<SXElem>& entries);

}  // namespace saltus::model
