#include "saltus/ode/bernstein.hpp"

#include "saltus/ode/bernstein_data_internal.hpp"

namespace saltus::ode {

const std::array<double, event_nodes>& interpolation_nodes() { return lobatto_nodes; }

const std::array<double, event_degree>& check_nodes() { return between_nodes; }

// The matrix B_i(node_j) is totally positive: elimination without pivoting has no cancellation, its residual is a few
// roundings of the coefficients. The explicit inverse would have errors of 184 roundings of the values, and they show
// in the values of the polynomial, since those of neighbouring coefficients do not cancel.
BernsteinCoefficients to_bernstein(std::span<const double, event_nodes> values) {
  constexpr std::size_t n = inner_nodes;
  const double first = values.front();
  const double last = values.back();
  std::array<double, n> rest;
  for (std::size_t j = 0; j < n; ++j) rest[j] = values[j + 1] - (first_basis[j] * first + last_basis[j] * last);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) rest[i] -= lower_columns[k][i] * rest[k];
  }
  for (std::size_t k = n; k-- > 0;) {
    rest[k] *= inverse_pivots[k];
    for (std::size_t i = 0; i < k; ++i) rest[i] -= upper_columns[k][i] * rest[k];
  }
  BernsteinCoefficients coefficients;
  coefficients.front() = first;
  for (std::size_t i = 0; i < n; ++i) coefficients[i + 1] = rest[i];
  coefficients.back() = last;
  return coefficients;
}

namespace {

/// Corner cutting down to two coefficients, those of the tangent at theta.
std::array<double, 2> tangent(const BernsteinCoefficients& coefficients, double theta) {
  BernsteinCoefficients b = coefficients;
  for (std::size_t level = b.size() - 1; level > 1; --level) {
    for (std::size_t i = 0; i < level; ++i) b[i] = (1.0 - theta) * b[i] + theta * b[i + 1];
  }
  return {b[0], b[1]};
}

}  // namespace

double evaluate(const BernsteinCoefficients& coefficients, double theta) {
  const auto [first, second] = tangent(coefficients, theta);
  return (1.0 - theta) * first + theta * second;
}

double derivative(const BernsteinCoefficients& coefficients, double theta) {
  const auto [first, second] = tangent(coefficients, theta);
  return event_degree * (second - first);
}

}  // namespace saltus::ode
