#include <map>

#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

// Needs names that only the headers above bring.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/preparation.hpp"

namespace saltus::model {

using casadi::SX;
using casadi::SXElem;

namespace {

/// CasADi keeps x - 0*y as it is; entries that are 0 stay 0 here.
SXElem nonzero_product(const SXElem& a, const SXElem& b) { return a.is_zero() || b.is_zero() ? SXElem(0.0) : a * b; }

SXElem minus_term(const SXElem& a, const SXElem& b) { return b.is_zero() ? a : a - b; }

/// Entries of a column that are not 0, on its diagonal and below, by rows.
std::map<casadi_int, SXElem> lower_column(const SX& matrix, casadi_int j) {
  const auto& sparsity = matrix.sparsity();
  std::map<casadi_int, SXElem> entries;
  for (casadi_int k = sparsity.colind()[j]; k < sparsity.colind()[j + 1]; ++k) {
    const SXElem& entry = matrix.nonzeros()[at(k)];
    if (sparsity.row()[k] >= j && !entry.is_zero()) entries.emplace(sparsity.row()[k], entry);
  }
  return entries;
}

/// Which expressions have one of the symbols in them, in one pass over their operations.
std::vector<bool> with_symbols(const std::vector<SXElem>& expressions, const SX& symbols) {
  const casadi::Function tape("tape", {symbols}, {SX(expressions)}, {{"allow_free", true}});
  std::vector<bool> work(tape.sz_w(), false), found(expressions.size(), false);
  for (casadi_int k = 0; k < tape.n_instructions(); ++k) {
    const auto operation = tape.instruction_id(k);
    const auto out = tape.instruction_output(k);
    const auto in = operation == casadi::OP_CONST || operation == casadi::OP_PARAMETER ? std::vector<casadi_int>()
                                                                                       : tape.instruction_input(k);
    if (operation == casadi::OP_OUTPUT) {
      found[at(out[1])] = work[at(in[0])];
      continue;
    }
    bool any = operation == casadi::OP_INPUT;
    for (const auto operand : in) any = any || (operation != casadi::OP_INPUT && work[at(operand)]);
    for (const auto place : out) work[at(place)] = any;
  }
  return found;
}

}  // namespace

/// NOTE: with the columns to the left taken in their order, each entry is the same expression as from full rows.
SymbolicLdl::SymbolicLdl(const SX& m, const SX& moving) : rows_(at(m.size1())), columns_(at(m.size1())) {
  const casadi_int n = m.size1();
  for (casadi_int j = 0; j < n; ++j) {
    prepares("solving for accelerations", at(j), at(n));
    auto entries = lower_column(m, j);
    SXElem& pivot = entries.try_emplace(j, 0.0).first->second;
    for (const auto& [k, l] : rows_[at(j)]) {
      const SXElem& d = pivots_[at(k)];
      for (const auto& [i, below] : columns_[at(k)]) {
        if (i < j) continue;
        SXElem& entry = entries.try_emplace(i, 0.0).first->second;
        entry = minus_term(entry, nonzero_product(nonzero_product(below, l), d));
      }
    }
    pivots_.push_back(pivot);
    for (const auto& [i, entry] : entries) {
      if (i == j || entry.is_zero()) continue;
      const SXElem l = entry / pivot;
      columns_[at(j)].emplace_back(i, l);
      rows_[at(i)].emplace_back(j, l);
    }
  }
  // NOTE: a root adds less than the rounding of a positive pivot, and is no number of a negative one. CasADi would fold
  // a product that is always 0; an exponential below all numbers it keeps.
  constexpr double nothing = 1e-300, below_all = -1e3;
  divisors_ = pivots_;
  zeros_.assign(at(n), SXElem(0.0));
  const auto moves = n > 0 ? with_symbols(pivots_, moving) : std::vector<bool>();
  for (std::size_t j = 0; j < moves.size(); ++j) {
    if (!moves[j]) continue;
    divisors_[j] = pivots_[j] + nothing * sqrt(pivots_[j]);
    zeros_[j] = exp(below_all - sqrt(pivots_[j]));
  }
}

std::size_t SymbolicLdl::entries_below() const {
  std::size_t count = 0;
  for (const auto& row : rows_) count += row.size();
  return count;
}

SX SymbolicLdl::solve(const SX& right) const { return solve(right, std::vector<SXElem>(rows_.size(), SXElem(0.0))); }

SX SymbolicLdl::accelerations(const SX& force) const { return solve(force, zeros_); }

/// @param zeros  n: what a row has for a right-hand side that is 0
SX SymbolicLdl::solve(const SX& right, const std::vector<SXElem>& zeros) const {
  SX result = SX::densify(right);
  const std::size_t n = rows_.size();
  const auto take = [](SXElem& entry, const Entries& factors, const SXElem* x) {
    for (const auto& [k, l] : factors) entry = minus_term(entry, nonzero_product(l, x[k]));
  };
  for (std::size_t c = 0; c < at(result.size2()); ++c) {
    SXElem* x = result.nonzeros().data() + c * n;
    for (std::size_t i = 0; i < n; ++i) take(x[i], rows_[i], x);
    for (std::size_t i = 0; i < n; ++i) x[i] = x[i].is_zero() ? zeros[i] : x[i] / divisors_[i];
    for (std::size_t i = n; i-- > 0;) take(x[i], columns_[i], x);
  }
  return result;
}

}  // namespace saltus::model
