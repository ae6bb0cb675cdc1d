#include <casadi/core/sx_elem.hpp>

#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {

using casadi::SX;
using casadi::SXElem;

namespace {

/// CasADi keeps x - 0*y as it is; entries that are 0 stay 0 here.
SXElem nonzero_product(const SXElem& a, const SXElem& b) { return a.is_zero() || b.is_zero() ? SXElem(0.0) : a * b; }

SXElem minus_term(const SXElem& a, const SXElem& b) { return b.is_zero() ? a : a - b; }

SXElem ldl_entry(const SX& matrix, casadi_int i, casadi_int j) {
  return static_cast<SXElem>(SX(matrix(i, j)).scalar());
}

}  // namespace

SymbolicLdl::SymbolicLdl(const SX& m, const SX& moving)
    : lower_(SX::zeros(m.size1(), m.size1())), pivots_(SX::zeros(m.size1(), 1)) {
  const casadi_int n = m.size1();
  const SX dense = SX::densify(m);
  for (casadi_int j = 0; j < n; ++j) {
    SXElem pivot = ldl_entry(dense, j, j);
    for (casadi_int k = 0; k < j; ++k) {
      const SXElem l = ldl_entry(lower_, j, k);
      pivot = minus_term(pivot, nonzero_product(nonzero_product(l, l), ldl_entry(pivots_, k, 0)));
    }
    pivots_(j) = pivot;
    for (casadi_int i = j + 1; i < n; ++i) {
      SXElem e = ldl_entry(dense, i, j);
      for (casadi_int k = 0; k < j; ++k) {
        e = minus_term(e, nonzero_product(nonzero_product(ldl_entry(lower_, i, k), ldl_entry(lower_, j, k)),
                                          ldl_entry(pivots_, k, 0)));
      }
      lower_(i, j) = e.is_zero() ? SXElem(0.0) : e / pivot;
    }
  }
  // NOTE: a root adds less than the rounding of a positive pivot, and is no number of a negative one. CasADi would fold
  // a product that is always 0; an exponential below all numbers it keeps.
  constexpr double nothing = 1e-300, below_all = -1e3;
  divisors_ = pivots_;
  zeros_ = SX::zeros(n, 1);
  for (casadi_int j = 0; j < n; ++j) {
    if (!SX::depends_on(pivots_(j), moving)) continue;
    divisors_(j) = pivots_(j) + nothing * sqrt(pivots_(j));
    zeros_(j) = exp(below_all - sqrt(pivots_(j)));
  }
}

SX SymbolicLdl::solve(const SX& right) const { return solve(right, SX::zeros(lower_.size1(), 1)); }

SX SymbolicLdl::accelerations(const SX& force) const { return solve(force, zeros_); }

/// @param zeros  n: what a row has for a right-hand side that is 0
SX SymbolicLdl::solve(const SX& right, const SX& zeros) const {
  const casadi_int n = lower_.size1();
  SX x = SX::densify(right);
  for (casadi_int c = 0; c < x.size2(); ++c) {
    for (casadi_int i = 0; i < n; ++i) {
      SXElem e = ldl_entry(x, i, c);
      for (casadi_int k = 0; k < i; ++k)
        e = minus_term(e, nonzero_product(ldl_entry(lower_, i, k), ldl_entry(x, k, c)));
      x(i, c) = e;
    }
    for (casadi_int i = 0; i < n; ++i) {
      const SXElem e = ldl_entry(x, i, c);
      x(i, c) = e.is_zero() ? ldl_entry(zeros, i, 0) : e / ldl_entry(divisors_, i, 0);
    }
    for (casadi_int i = n - 1; i >= 0; --i) {
      SXElem e = ldl_entry(x, i, c);
      for (casadi_int k = i + 1; k < n; ++k)
        e = minus_term(e, nonzero_product(ldl_entry(lower_, k, i), ldl_entry(x, k, c)));
      x(i, c) = e;
    }
  }
  return x;
}

}  // namespace saltus::model
