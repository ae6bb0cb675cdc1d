#include <casadi/core/sx_elem.hpp>

#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {

using casadi::SX;
using casadi::SXElem;

SX eliminate(const SX& matrix, const SX& right, Symmetry symmetry) {
  const casadi_int n = matrix.size1();
  const bool symmetric = symmetry == Symmetry::symmetric;
  const auto at = [n](casadi_int i, casadi_int j) { return static_cast<std::size_t>(i + j * n); };
  std::vector<SXElem> a = SX::densify(matrix).nonzeros();
  std::vector<SXElem> b = SX::densify(right).nonzeros();
  const auto subtract = [](SXElem& from, const SXElem& x, const SXElem& y) {
    if (!x.is_zero() && !y.is_zero()) from = from - x * y;
  };
  for (casadi_int k = 0; k < n; ++k) {
    for (casadi_int i = k + 1; i < n; ++i) {
      const SXElem below = symmetric ? a[at(k, i)] : a[at(i, k)];
      if (below.is_zero()) continue;
      const SXElem factor = below / a[at(k, k)];
      for (casadi_int j = symmetric ? i : k + 1; j < n; ++j) subtract(a[at(i, j)], factor, a[at(k, j)]);
      subtract(b[at(i, 0)], factor, b[at(k, 0)]);
    }
  }
  for (casadi_int i = n - 1; i >= 0; --i) {
    for (casadi_int j = i + 1; j < n; ++j) subtract(b[at(i, 0)], a[at(i, j)], b[at(j, 0)]);
    if (!b[at(i, 0)].is_zero()) b[at(i, 0)] = b[at(i, 0)] / a[at(i, i)];
  }
  return SX(casadi::Sparsity::dense(n, 1), b);
}

}  // namespace saltus::model
