// Bernstein polynomials by powers of r = theta / (1 - theta), from the nearer end: all powers are at most 1, and no
// more cancels than between the Bernstein polynomials themselves.
#pragma once

#include <array>

#include "saltus/ode/bernstein.hpp"

namespace saltus::ode {

static_assert(event_degree == 8);
inline constexpr std::array<double, 9> binomials_of_8{1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0};
inline constexpr std::array<double, 8> binomials_of_7{1.0, 7.0, 21.0, 35.0, 35.0, 21.0, 7.0, 1.0};

/// Evaluates c(0) + c(1) r + ... + c(7) r^7 in pairs and pairs of pairs: a third of the waiting of Horner's rule.
template <class Value, class Coefficient>
inline Value seventh_degree(Coefficient&& c, Value r) {
  const Value square = r * r;
  const Value low = (c(0) + c(1) * r) + (c(2) + c(3) * r) * square;
  const Value high = (c(4) + c(5) * r) + (c(6) + c(7) * r) * square;
  return low + high * (square * square);
}

}  // namespace saltus::ode
