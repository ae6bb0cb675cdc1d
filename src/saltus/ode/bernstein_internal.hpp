// Polynomials in Bernstein form on [0, 1], of any degree.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace saltus::ode {

constexpr double binomial(std::size_t n, std::size_t k) {
  double value = 1.0;
  for (std::size_t j = 1; j <= k; ++j) value = value * static_cast<double>(n - k + j) / static_cast<double>(j);
  return value;
}

/// Returns 1 / C(degree, k).
template <std::size_t degree>
constexpr auto inverse_binomials() {
  std::array<double, degree + 1> row{};
  for (std::size_t k = 0; k <= degree; ++k) row[k] = 1.0 / binomial(degree, k);
  return row;
}

/// Puts in place of b_j the sum of C(j, k) b_k over k, j = 0 ... degree: Bernstein coefficients from the terms of a
/// power series over C(degree, k). By sums of neighbours, all of them written out.
template <std::size_t degree, class Value, std::size_t... j>
[[gnu::always_inline]] inline void add_neighbours(Value* b, std::index_sequence<j...>) {
  ((b[degree - j] += b[degree - j - 1]), ...);
}
template <std::size_t degree, class Value, std::size_t... row>
[[gnu::always_inline]] inline void binomial_sums(Value* b, std::index_sequence<row...>) {
  (add_neighbours<degree>(b, std::make_index_sequence<degree - row>{}), ...);
}
template <std::size_t degree, class Value>
[[gnu::always_inline]] inline void binomial_sums(Value* b) {
  binomial_sums<degree>(b, std::make_index_sequence<degree>{});
}

/// Cuts corners down to two coefficients, those of the tangent at theta.
template <std::size_t nodes>
std::array<double, 2> tangent(const std::array<double, nodes>& coefficients, double theta) {
  std::array<double, nodes> b = coefficients;
  for (std::size_t level = b.size() - 1; level > 1; --level) {
    for (std::size_t i = 0; i < level; ++i) b[i] = (1.0 - theta) * b[i] + theta * b[i + 1];
  }
  return {b[0], b[1]};
}

template <std::size_t nodes>
double value_at(const std::array<double, nodes>& coefficients, double theta) {
  const auto [first, second] = tangent(coefficients, theta);
  return (1.0 - theta) * first + theta * second;
}

template <std::size_t nodes>
double slope_at(const std::array<double, nodes>& coefficients, double theta) {
  const auto [first, second] = tangent(coefficients, theta);
  return static_cast<double>(nodes - 1) * (second - first);
}

}  // namespace saltus::ode
