// Rebuilding CasADi expressions: replacing symbols, additive terms, products with a weight that may be 0.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

namespace saltus::reformulation {

using casadi::SX;
using casadi::SXElem;

/// Puts values for symbols. Guards that their weight has opened are taken away.
class Replacement {
 public:
  void set(const SXElem& symbol, const SXElem& value);
  void set(const SX& symbols, const SX& values);
  [[nodiscard]] bool empty() const { return values_.empty(); }
  /// Cost: linear in the size of the expression.
  [[nodiscard]] SXElem of(const SXElem& expression) const;
  [[nodiscard]] SX of(const SX& expression) const;

 private:
  using Known = std::unordered_map<const void*, SXElem>;
  [[nodiscard]] SXElem of(const SXElem& expression, Known& known) const;

  Known values_;
  std::vector<SXElem> symbols_;  ///< the addresses in values_ stay theirs
};

/// Returns the symbols an expression is made of.
[[nodiscard]] std::vector<SXElem> symbols_in(const SX& expression);

/// Returns terms whose sum is the expression, as fine as its structure allows: products are multiplied out where only
/// one factor has some of the symbols. What has none of them is not taken apart.
[[nodiscard]] std::vector<SXElem> additive_terms(const SXElem& expression,
                                                 const std::unordered_set<const void*>& symbols);

/// Returns whether branches of an expression can be NaN or infinite at finite values; operations on constants and
/// `constants` (parameters) alone are taken to be finite.
[[nodiscard]] bool may_be_nonfinite(const SXElem& expression, const SX& constants);

/// Returns weight * branch, and 0 where the weight is 0 whatever the branch is.
[[nodiscard]] SXElem weighted(const SXElem& weight, const SXElem& branch, const SX& constants);

/// Returns the scalar's only entry, 0 if it is structurally zero.
[[nodiscard]] SXElem entry(const SX& scalar);

/// Returns a dense column.
[[nodiscard]] SX column(const std::vector<SXElem>& entries);

/// Returns the entries of a column, structural zeros among them.
[[nodiscard]] std::vector<SXElem> entries(const SX& column);

}  // namespace saltus::reformulation
