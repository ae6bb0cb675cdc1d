// Problems with complementarities whose solutions and stationary points are known in closed form.
#pragma once

#include <limits>

#include "../mpcc/polynomial_problem.hpp"

namespace saltus::solver::small {

using mpcc::Monomial;
using mpcc::Polynomial;
using mpcc::PolynomialProblem;
using mpcc::PolynomialStatement;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// w_i.
inline Polynomial variable(int i) {
  std::vector<int> powers(static_cast<std::size_t>(i) + 1, 0);
  powers.back() = 1;
  return {{{1.0, powers}}};
}

/// n variables, pairs (w0, w1), (w2, w3), ...; no bounds.
inline PolynomialStatement statement(int variables, int pairs, Polynomial f) {
  PolynomialStatement result;
  result.variables = variables;
  result.f = std::move(f);
  result.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  for (int pair = 0; pair < pairs; ++pair) {
    result.G.push_back(variable(2 * pair));
    result.H.push_back(variable(2 * pair + 1));
  }
  result.w_bounds = {linalg::Vector::constant(variables, -infinity), linalg::Vector::constant(variables, infinity)};
  return result;
}

inline void add_row(PolynomialStatement& to, Polynomial g, double lower, double upper) {
  to.g.push_back(std::move(g));
  auto& bounds = to.g_bounds;
  const linalg::Index rows = bounds.lower.size();
  bounds.lower.resize_and_keep(rows + 1);
  bounds.upper.resize_and_keep(rows + 1);
  bounds.lower[rows] = lower;
  bounds.upper[rows] = upper;
}

/// Sides that are bounds of variables instead of constraints.
/// Only for pairs of variables in order.
inline void imply_signs(PolynomialStatement& to) {
  to.w_bounds.lower.head(2 * static_cast<int>(to.G.size())).set_zero();
}
inline void imply_signs(PolynomialProblem& of) {
  for (int side = 0; side < 2 * of.pairs(); ++side) of.set_sign(side, mpcc::Sign::implied);
}

/// (w0 - a)^2 + (w1 - b)^2.
inline Polynomial distance(double a, double b) {
  return {{{1.0, {2}}, {-2.0 * a, {1}}, {1.0, {0, 2}}, {-2.0 * b, {0, 1}}, {a * a + b * b, {}}}};
}

/// min (w0 - 1)^2 + w1^3 + w1^2: (1, 0), value 0.
inline PolynomialStatement minimum_on_one_axis() {
  return statement(2, 1, {{{1.0, {2}}, {-2.0, {1}}, {1.0, {}}, {1.0, {0, 3}}, {1.0, {0, 2}}}});
}
/// min w0 + w1 - w2, 4 w0 >= w2, 4 w1 >= w2: 0, B-stationary, not strongly so (scholtes4 of MacMPEC).
inline PolynomialStatement b_not_strong() {
  auto result = statement(3, 1, {{{1.0, {1}}, {1.0, {0, 1}}, {-1.0, {0, 0, 1}}}});
  add_row(result, {{{4.0, {1}}, {-1.0, {0, 0, 1}}}}, 0.0, infinity);
  add_row(result, {{{4.0, {0, 1}}, {-1.0, {0, 0, 1}}}}, 0.0, infinity);
  return result;
}

}  // namespace saltus::solver::small
