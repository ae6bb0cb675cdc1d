// The derivatives of a Problem against central differences; for tests of everything that implements one.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Dense form of values of a pattern; entries of the same place add up.
inline linalg::Matrix dense(const Pattern& pattern, const linalg::Vector& values, int rows, int columns) {
  linalg::Matrix matrix = linalg::Matrix::zero(rows, columns);
  for (int e = 0; e < pattern.entries(); ++e) {
    matrix(pattern.row[static_cast<std::size_t>(e)], pattern.column[static_cast<std::size_t>(e)]) += values[e];
  }
  return matrix;
}

inline linalg::Matrix dense_jacobian(Problem& problem, const linalg::Vector& w) {
  linalg::Vector values(problem.jacobian_pattern().entries());
  problem.jacobian(w, values);
  return dense(problem.jacobian_pattern(), values, problem.rows(), problem.variables());
}

/// The whole symmetric matrix.
inline linalg::Matrix dense_hessian(Problem& problem, const linalg::Vector& w, double factor, const linalg::Vector& y) {
  linalg::Vector values(problem.hessian_pattern().entries());
  problem.hessian(w, factor, y, values);
  const int n = problem.variables();
  const linalg::Matrix lower = dense(problem.hessian_pattern(), values, n, n);
  for (int i = 0; i < n; ++i) EXPECT_TRUE(lower.row(i).tail(n - i - 1).is_zero());
  linalg::Matrix whole = lower + lower.transpose();
  whole.diagonal() = lower.diagonal();
  return whole;
}

/// Gradient, Jacobian and Hessian at w, each relative to its largest entry. Central differences with step 1e-5 of
/// functions of order 1 are good to about 1e-10 (step^2) + 1e-11 (rounding over step); 1e-7 leaves room for steep ones.
inline void expect_correct_derivatives(Problem& problem, const linalg::Vector& w, double tolerance = 1e-7) {
  const double step = 1e-5;
  const int n = problem.variables();
  const int m = problem.rows();
  const double factor = 0.7;
  linalg::Vector y(m);
  for (int row = 0; row < m; ++row) y[row] = m > 1 ? -1.0 + 2.3 * row / (m - 1) : 1.3;
  linalg::Vector gradient(n);
  problem.objective_gradient(w, gradient);
  const linalg::Matrix jacobian = dense_jacobian(problem, w);
  const linalg::Matrix hessian = dense_hessian(problem, w, factor, y);

  const auto lagrangian_gradient = [&](const linalg::Vector& at) -> linalg::Vector {
    linalg::Vector of_f(n);
    problem.objective_gradient(at, of_f);
    linalg::Vector sum = factor * of_f;
    linalg::Vector entries(problem.jacobian_pattern().entries());
    problem.jacobian(at, entries);
    for (int e = 0; e < entries.size(); ++e) {
      const auto place = static_cast<std::size_t>(e);
      sum[problem.jacobian_pattern().column[place]] += entries[e] * y[problem.jacobian_pattern().row[place]];
    }
    return sum;
  };
  const double gradient_size = 1.0 + gradient.max_abs();
  const double jacobian_size = 1.0 + jacobian.max_abs();
  const double hessian_size = 1.0 + hessian.max_abs();
  linalg::Vector c_plus(m);
  linalg::Vector c_minus(m);
  for (int i = 0; i < n; ++i) {
    linalg::Vector plus = w;
    linalg::Vector minus = w;
    plus[i] += step;
    minus[i] -= step;
    const double width = plus[i] - minus[i];
    const double slope = (problem.objective(plus) - problem.objective(minus)) / width;
    EXPECT_NEAR(gradient[i], slope, tolerance * gradient_size) << "df/dw_" << i;
    problem.functions(plus, c_plus);
    problem.functions(minus, c_minus);
    const linalg::Vector column = (c_plus - c_minus) / width;
    for (int row = 0; row < m; ++row) {
      EXPECT_NEAR(jacobian(row, i), column[row], tolerance * jacobian_size) << "dc_" << row << "/dw_" << i;
    }
    const linalg::Vector second = (lagrangian_gradient(plus) - lagrangian_gradient(minus)) / width;
    for (int row = 0; row < n; ++row) {
      EXPECT_NEAR(hessian(row, i), second[row], tolerance * hessian_size) << "d2L/dw_" << row << "dw_" << i;
    }
  }
}

}  // namespace saltus::mpcc
