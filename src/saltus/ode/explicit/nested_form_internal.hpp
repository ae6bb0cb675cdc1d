// The dense output in its nested form, with s = theta and r = 1 - theta:
//   x(t + theta h) = c0 + s (c1 + r (c2 + s (c3 + r (c4 + ...)))).
#pragma once

#include <array>
#include <cstddef>

namespace saltus::ode {

/// Holds the value and derivative with respect to theta.
struct Jet {
  double value;
  double slope;
};

/// Evaluates c_first + factor (c_first+1 + ...), factors s and r in turn: s behind even coefficients, r behind odd
/// ones.
template <std::size_t first, std::size_t last>
inline double nested(const double* coefficients, std::size_t n, std::size_t i, double s, double r) {
  const double own = coefficients[first * n + i];
  if constexpr (first == last) {
    return own;
  } else {
    return own + (first % 2 == 0 ? s : r) * nested<first + 1, last>(coefficients, n, i, s, r);
  }
}

template <std::size_t first, std::size_t last>
inline Jet nested_jet(const double* coefficients, std::size_t n, std::size_t i, double s, double r) {
  const double own = coefficients[first * n + i];
  if constexpr (first == last) {
    return {own, 0.0};
  } else {
    const Jet inner = nested_jet<first + 1, last>(coefficients, n, i, s, r);
    if constexpr (first % 2 == 0) {
      return {own + s * inner.value, inner.value + s * inner.slope};
    } else {
      return {own + r * inner.value, r * inner.slope - inner.value};
    }
  }
}

/// Returns a sign, as the nested form is the Newton form with the nodes 0, 1, 0, 1, ..., but for the sign of its
/// factors 1 - theta: that of its coefficient k.
inline double sign_of_nested(std::size_t k) { return k / 2 % 2 == 0 ? 1.0 : -1.0; }

/// Makes a Newton form c0 + (theta - node0) (c1 + (theta - node1) (c2 + ...)) with another node in front of the others,
/// of which the last one is dropped. Coefficients are numbers or columns.
template <std::size_t others, class Coefficients>
inline void begin_with_node(double node, Coefficients& c, std::array<double, others>& nodes) {
  for (std::size_t k = others; k-- > 0;) c[k] += (node - nodes[k]) * c[k + 1];
  for (std::size_t k = others - 1; k > 0; --k) nodes[k] = nodes[k - 1];
  nodes[0] = node;
}

/// Holds the value, derivative and half the second derivative.
struct SecondJet {
  double value;
  double slope;
  double bend;
};

template <std::size_t first, std::size_t last>
inline SecondJet nested_second_jet(const double* coefficients, double s, double r) {
  const double own = coefficients[first];
  if constexpr (first == last) {
    return {own, 0.0, 0.0};
  } else {
    const SecondJet inner = nested_second_jet<first + 1, last>(coefficients, s, r);
    if constexpr (first % 2 == 0) {
      return {own + s * inner.value, inner.value + s * inner.slope, inner.slope + s * inner.bend};
    } else {
      return {own + r * inner.value, r * inner.slope - inner.value, r * inner.bend - inner.slope};
    }
  }
}

/// Returns the power of s and r that coefficient k of the form is multiplied by.
constexpr std::size_t power_of_s(std::size_t k) { return (k + 1) / 2; }
constexpr std::size_t power_of_r(std::size_t k) { return k / 2; }

}  // namespace saltus::ode
