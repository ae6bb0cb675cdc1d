#include "saltus/ode/bernstein.hpp"

#include "saltus/ode/bernstein_data_internal.hpp"
#include "saltus/ode/explicit/ratio_form_internal.hpp"

namespace saltus::ode {

const std::array<double, event_nodes>& interpolation_nodes() { return lobatto_nodes; }

const std::array<double, event_degree>& check_nodes() { return between_nodes; }

// The matrix B_i(node_j) is totally positive: elimination without pivoting has no cancellation, its residual is a few
// roundings of the coefficients. The explicit inverse would have errors of 184 roundings of the values. They show in
// the values of the polynomial, since those of neighbouring coefficients do not cancel.
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

double evaluate(const BernsteinCoefficients& coefficients, double theta) {
  BernsteinCoefficients b = coefficients;
  for (std::size_t level = b.size() - 1; level > 0; --level) {
    for (std::size_t i = 0; i < level; ++i) b[i] = (1.0 - theta) * b[i] + theta * b[i + 1];
  }
  return b.front();
}

double derivative(const BernsteinCoefficients& b, double theta) {
  const bool from_start = theta <= 0.5;
  const double far = 1.0 - theta;
  const double ratio = from_start ? theta / far : far / theta;
  const auto difference = [&](std::size_t i) { return binomials_of_7[i] * (b[i + 1] - b[i]); };
  const double sum = from_start ? seventh_degree(difference, ratio)
                                : seventh_degree([&](std::size_t i) { return difference(7 - i); }, ratio);
  const double nearer = from_start ? far : theta;
  const double square = nearer * nearer;
  return event_degree * (sum * (square * square) * (square * nearer));
}

}  // namespace saltus::ode
