// The linear part of an affine right-hand side.
#pragma once

#include <cstddef>
#include <vector>

namespace saltus::ode {

/// Holds A and c of f(t, x) = A x + b + c t, for n states. Derivatives of solutions need no more: x'' = A x' + c.
struct LinearField {
  std::vector<double> diagonal;  ///< of A, n
  std::vector<std::size_t> start,
      column;  ///< the rest of row i: entries start_i ... start_(i+1) - 1; empty without any
  std::vector<double> entry;
  std::vector<double> rate;  ///< c, n; empty if it is 0

  bool operator==(const LinearField&) const = default;
};

}  // namespace saltus::ode
