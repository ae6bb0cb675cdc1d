// What is read off the nested form of the dense output.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "saltus/base/contracts.hpp"
#include "saltus/ode/bernstein_internal.hpp"
#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/explicit/nested_form_internal.hpp"
#include "saltus/ode/series_internal.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {
namespace {

template <std::size_t degree>
inline double value_from_start(const double* coefficients, std::size_t n, std::size_t i, double theta) {
  return nested<0, degree>(coefficients, n, i, theta, 1.0 - theta);
}

/// The same polynomial written from its other end, x(t + h) - r (c1 - s (c2 + ...)): rounding vanishes towards that
/// end.
template <std::size_t degree>
inline double value_from_end(const double* coefficients, const double* end, std::size_t n, std::size_t i,
                             double theta) {
  const double s = theta;
  const double r = 1.0 - theta;
  return end[i] - r * (coefficients[n + i] - s * nested<2, degree>(coefficients, n, i, s, r));
}

template <std::size_t degree>
void evaluate_slope(const double* coefficients, std::size_t n, double theta, double h, double* __restrict xdot) {
  for (std::size_t i = 0; i < n; ++i) {
    xdot[i] = nested_jet<0, degree>(coefficients, n, i, theta, 1.0 - theta).slope / h;
  }
}

template <std::size_t degree>
void evaluate_nearer(const double* coefficients, const double* end, std::size_t n, double theta, double* __restrict x) {
  if (theta <= 0.5) {
    for (std::size_t i = 0; i < n; ++i) x[i] = value_from_start<degree>(coefficients, n, i, theta);
  } else {
    for (std::size_t i = 0; i < n; ++i) x[i] = value_from_end<degree>(coefficients, end, n, i, theta);
  }
}

/// Largest values on [0, 1] of the factors s r, s^2 r, s^2 r^2, ... of the coefficients 2, 3, 4, ...
constexpr std::array<double, 6> largest_factors{1.0 / 4.0,      4.0 / 27.0, 1.0 / 16.0,
                                                108.0 / 3125.0, 1.0 / 64.0, 6912.0 / 823543.0};

template <std::size_t degree>
void polynomial_bounds(const double* coefficients, const double* end, std::size_t n, double* __restrict low,
                       double* __restrict high) {
  for (std::size_t i = 0; i < n; ++i) {
    double width = 0.0;
    for (std::size_t k = 2; k <= degree; ++k) width += largest_factors[k - 2] * std::abs(coefficients[k * n + i]);
    const double begin = coefficients[i];
    low[i] = std::min(begin, end[i]) - width;
    high[i] = std::max(begin, end[i]) + width;
  }
}

/// Bernstein coefficients, two at a time, with a last one that is nobody's.
using BernsteinPairs = std::array<Pair, (event_nodes + 1) / 2>;

/// Bernstein coefficients, of degree event_degree, of the products 1, s, s r, s^2 r, s^2 r^2, ... which the nested form
/// is a sum of: s^a r^b is the sum of C(N - a - b, i - a) / C(N, i) times B_i, i = a ... N - b.
constexpr auto products = [] {
  constexpr std::size_t degree = event_degree;
  std::array<BernsteinPairs, degree> table{};
  for (std::size_t k = 0; k < table.size(); ++k) {
    const std::size_t a = power_of_s(k);
    const std::size_t b = power_of_r(k);
    double numbers[event_nodes + 1] = {};
    for (std::size_t i = a; i + b <= degree; ++i) numbers[i] = binomial(degree - k, i - a) / binomial(degree, i);
    for (std::size_t q = 0; q < table[k].size(); ++q) table[k][q] = Pair{numbers[2 * q], numbers[2 * q + 1]};
  }
  return table;
}();

/// Adds a coefficient of the nested form, where its product is not 0.
template <std::size_t k>
inline void add_pairs_of_product(double coefficient, BernsteinPairs& b) {
  const Pair both{coefficient, coefficient};
  for (std::size_t q = (k + 1) / 4; q <= (event_degree - k / 2) / 2; ++q) b[q] += products[k][q] * both;
}

template <std::size_t degree, std::size_t... k>
inline void add_products(const double* coefficients, std::size_t n, std::size_t i, BernsteinPairs& b,
                         std::index_sequence<k...>) {
  static_assert(degree < products.size());
  (add_pairs_of_product<k + 1>(coefficients[(k + 1) * n + i], b), ...);
}

template <std::size_t... k>
inline void add_component(const double* own, std::size_t n, double factor, NestedPolynomial& sum,
                          std::index_sequence<k...>) {
  ((sum.c[k] += factor * own[k * n]), ...);
}
template <std::size_t degree>
inline void add_component(const double* own, std::size_t n, double factor, NestedPolynomial& sum) {
  sum.degree = static_cast<int>(degree);
  add_component(own, n, factor, sum, std::make_index_sequence<degree + 1>{});
}

template <std::size_t degree>
BernsteinCoefficients bernstein_form(const double* coefficients, std::size_t n, std::size_t i, double end) {
  BernsteinPairs pairs;
  pairs.fill(Pair{coefficients[i], coefficients[i]});
  add_products<degree>(coefficients, n, i, pairs, std::make_index_sequence<degree>{});
  BernsteinCoefficients b;
  for (std::size_t q = 0; q + 1 < pairs.size(); ++q) store(b.data() + 2 * q, pairs[q]);
  b.back() = end;
  return b;
}

/// The nested form on [from, to]: its Newton form gets the nodes `from` and `to` in turn, the last one first.
template <std::size_t degree>
void cut_component(double* coefficients, std::size_t n, std::size_t i, double from, double to) {
  std::array<double, degree + 1> c;
  std::array<double, degree> nodes;
  for (std::size_t k = 0; k <= degree; ++k) c[k] = sign_of_nested(k) * coefficients[k * n + i];
  for (std::size_t k = 0; k < degree; ++k) nodes[k] = k % 2 == 0 ? 0.0 : 1.0;
  for (std::size_t k = degree; k-- > 0;) begin_with_node(k % 2 == 0 ? from : to, c, nodes);
  double power = 1.0;
  for (std::size_t k = 0; k <= degree; ++k, power *= to - from) {
    coefficients[k * n + i] = sign_of_nested(k) * power * c[k];
  }
}

/// Calls with the degree of the nested form as a constant.
template <class Take>
auto with_degree(Method method, Take&& take) {
  switch (method) {
    case Method::dopri5:
      return take(std::integral_constant<std::size_t, 4>{});
    case Method::radau9:
      return take(std::integral_constant<std::size_t, 5>{});
    case Method::dop853:
    case Method::radau13:
      return take(std::integral_constant<std::size_t, 7>{});
    case Method::radau5:
    case Method::taylor:
      break;
  }
  return take(std::integral_constant<std::size_t, 3>{});
}

}  // namespace

double DenseStep::value(std::size_t i, double theta) const {
  SALTUS_ASSERT(!is_series());
  if (theta == 0.0) return coefficients_[i];
  if (theta == 1.0) return end_[i];
  const auto n = static_cast<std::size_t>(n_);
  return with_degree(method_, [&](auto degree) {
    return theta <= 0.5 ? value_from_start<degree.value>(coefficients_.data(), n, i, theta)
                        : value_from_end<degree.value>(coefficients_.data(), end_.data(), n, i, theta);
  });
}

void DenseStep::cut(double from, double to) {
  SALTUS_ASSERT(!is_series() && 0.0 <= from && from < to && to <= 1.0);
  const std::size_t n = end_.size();
  std::vector<double> start(n), end(n);
  evaluate(from, start.data());
  evaluate(to, end.data());
  with_degree(method_, [&](auto degree) {
    for (std::size_t i = 0; i < n; ++i) cut_component<degree.value>(coefficients_.data(), n, i, from, to);
  });
  std::copy(start.begin(), start.end(), coefficients_.begin());
  end_ = std::move(end);
  t += from * h;
  h *= to - from;
}

void DenseStep::replace(std::size_t i, const DenseStep& other, std::size_t k) {
  SALTUS_ASSERT(method_ == other.method_ && !is_series());
  const auto n = static_cast<std::size_t>(n_), own = static_cast<std::size_t>(other.n_);
  for (std::size_t c = 0; c * n < coefficients_.size(); ++c) {
    coefficients_[c * n + i] = other.coefficients_[c * own + k];
  }
  end_[i] = other.end_[k];
}

SeriesCoefficients DenseStep::terms(std::size_t i) const {
  const double* place = coefficients_.data() + series_place(i);
  SeriesCoefficients terms;
  for (std::size_t k = 0; k < terms.size(); ++k) terms[k] = place[2 * k];
  return terms;
}

void DenseStep::add_nested(std::size_t i, double factor, NestedPolynomial& sum) const {
  SALTUS_ASSERT(!is_series());
  const double* own = coefficients_.data() + i;
  const auto n = static_cast<std::size_t>(n_);
  sum.end += factor * end_[i];
  with_degree(method_, [&](auto degree) { add_component<degree.value>(own, n, factor, sum); });
}

BernsteinCoefficients DenseStep::bernstein(std::size_t i) const {
  SALTUS_ASSERT(!is_series());
  const auto n = static_cast<std::size_t>(n_);
  return with_degree(method_,
                     [&](auto degree) { return bernstein_form<degree.value>(coefficients_.data(), n, i, end_[i]); });
}

void DenseStep::bounds(double* low, double* high) const {
  const auto n = static_cast<std::size_t>(n_);
  if (is_series()) return series_bounds(coefficients_.data(), n, low, high);
  with_degree(method_,
              [&](auto degree) { polynomial_bounds<degree.value>(coefficients_.data(), end_.data(), n, low, high); });
}

void DenseStep::evaluate(double theta, double* x) const {
  const std::size_t n = end_.size();
  if (theta == 0.0 || theta == 1.0) {  // bit for bit, the sign of a zero included
    if (theta == 0.0 && is_series()) return series_start(coefficients_.data(), n, x);
    std::copy_n(theta == 0.0 ? coefficients_.data() : end_.data(), n, x);
    return;
  }
  if (is_series()) return series_values(coefficients_.data(), n, theta, x);
  with_degree(method_,
              [&](auto degree) { evaluate_nearer<degree.value>(coefficients_.data(), end_.data(), n, theta, x); });
}

void DenseStep::derivative(double theta, double* xdot) const {
  const auto n = static_cast<std::size_t>(n_);
  if (is_series()) return series_slopes(coefficients_.data(), n, theta, h, xdot);
  with_degree(method_, [&](auto degree) { evaluate_slope<degree.value>(coefficients_.data(), n, theta, h, xdot); });
}

}  // namespace saltus::ode
