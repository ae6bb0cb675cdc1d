// The derivatives of a Problem against central differences; for tests of everything that implements one.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Dense form of values of a pattern; entries of the same place add up.
inline Eigen::MatrixXd dense(const Pattern& pattern, const Eigen::VectorXd& values, int rows, int columns) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, columns);
  for (int e = 0; e < pattern.entries(); ++e) {
    matrix(pattern.row[static_cast<std::size_t>(e)], pattern.column[static_cast<std::size_t>(e)]) += values[e];
  }
  return matrix;
}

inline Eigen::MatrixXd dense_jacobian(Problem& problem, const Eigen::VectorXd& w) {
  Eigen::VectorXd values(problem.jacobian_pattern().entries());
  problem.jacobian(w, values);
  return dense(problem.jacobian_pattern(), values, problem.rows(), problem.variables());
}

/// The whole symmetric matrix.
inline Eigen::MatrixXd dense_hessian(Problem& problem, const Eigen::VectorXd& w, double factor,
                                     const Eigen::VectorXd& y) {
  Eigen::VectorXd values(problem.hessian_pattern().entries());
  problem.hessian(w, factor, y, values);
  const int n = problem.variables();
  const Eigen::MatrixXd lower = dense(problem.hessian_pattern(), values, n, n);
  EXPECT_EQ(Eigen::MatrixXd(lower.triangularView<Eigen::StrictlyUpper>()).norm(), 0.0);
  Eigen::MatrixXd whole = lower + lower.transpose();
  whole.diagonal() = lower.diagonal();
  return whole;
}

/// Gradient, Jacobian and Hessian at w, each relative to its largest entry. Central differences with step 1e-5 of
/// functions of order 1 are good to about 1e-10 (step^2) + 1e-11 (rounding over step); 1e-7 leaves room for steep ones.
inline void expect_correct_derivatives(Problem& problem, const Eigen::VectorXd& w, double tolerance = 1e-7) {
  const double step = 1e-5;
  const int n = problem.variables();
  const int m = problem.rows();
  const double factor = 0.7;
  const Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(m, -1.0, 1.3);
  Eigen::VectorXd gradient(n);
  problem.objective_gradient(w, gradient);
  const Eigen::MatrixXd jacobian = dense_jacobian(problem, w);
  const Eigen::MatrixXd hessian = dense_hessian(problem, w, factor, y);

  const auto lagrangian_gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    Eigen::VectorXd of_f(n);
    problem.objective_gradient(at, of_f);
    Eigen::VectorXd sum = factor * of_f;
    Eigen::VectorXd entries(problem.jacobian_pattern().entries());
    problem.jacobian(at, entries);
    for (int e = 0; e < entries.size(); ++e) {
      const auto place = static_cast<std::size_t>(e);
      sum[problem.jacobian_pattern().column[place]] += entries[e] * y[problem.jacobian_pattern().row[place]];
    }
    return sum;
  };
  const double gradient_size = 1.0 + gradient.lpNorm<Eigen::Infinity>();
  const double jacobian_size = 1.0 + (m > 0 ? jacobian.lpNorm<Eigen::Infinity>() : 0.0);
  const double hessian_size = 1.0 + hessian.lpNorm<Eigen::Infinity>();
  Eigen::VectorXd c_plus(m);
  Eigen::VectorXd c_minus(m);
  for (int i = 0; i < n; ++i) {
    Eigen::VectorXd plus = w;
    Eigen::VectorXd minus = w;
    plus[i] += step;
    minus[i] -= step;
    const double width = plus[i] - minus[i];
    const double slope = (problem.objective(plus) - problem.objective(minus)) / width;
    EXPECT_NEAR(gradient[i], slope, tolerance * gradient_size) << "df/dw_" << i;
    problem.functions(plus, c_plus);
    problem.functions(minus, c_minus);
    const Eigen::VectorXd column = (c_plus - c_minus) / width;
    for (int row = 0; row < m; ++row) {
      EXPECT_NEAR(jacobian(row, i), column[row], tolerance * jacobian_size) << "dc_" << row << "/dw_" << i;
    }
    const Eigen::VectorXd second = (lagrangian_gradient(plus) - lagrangian_gradient(minus)) / width;
    for (int row = 0; row < n; ++row) {
      EXPECT_NEAR(hessian(row, i), second[row], tolerance * hessian_size) << "d2L/dw_" << row << "dw_" << i;
    }
  }
}

}  // namespace saltus::mpcc
