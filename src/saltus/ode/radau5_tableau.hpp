// Coefficients of the three-stage Radau IIA collocation method of order 5, its transformation to one real and one
// complex system, and its error estimate of order 3.
//
// Source: Hairer & Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, IV.5, IV.8, code RADAU5.
#pragma once

#include <array>
#include <cstddef>

namespace saltus::ode {

struct Radau5Tableau {
  static constexpr std::size_t stages = 3;

  /// (4 -+ sqrt 6) / 10 and 1.
  static constexpr std::array<double, stages> c{0.15505102572168219, 0.6449489742783178, 1.0};

  /// Eigenvalues of the inverse of the coefficient matrix A: gamma, alpha +- i beta.
  static constexpr double gamma = 3.6378342527444957;
  static constexpr double alpha = 2.6810828736277521;
  static constexpr double beta = 3.0504301992474106;

  /// inverse(A) t = t ((gamma, 0, 0), (0, alpha, -beta), (0, beta, alpha)).
  static constexpr std::array<std::array<double, stages>, stages> t{
      {{{0.09123239487089294, -0.14125529502095421, -0.03002919410514742}},
       {{0.24171793270710702, 0.204129352293799932, 0.38294211275726194}},
       {{0.96604818261509294, 1.0, 0.0}}}};
  static constexpr std::array<std::array<double, stages>, stages> t_inverse{
      {{{4.325579890063155, 0.33919925181580987, 0.54177053993587487}},
       {{-4.1787185915519047, -0.32768282076106239, 0.47662355450055045}},
       {{-0.50287263494578688, 2.5719269498556054, -0.59603920482822492}}}};

  /// Weights of the stages' increments in the error estimate: -(13 +- 7 sqrt 6) / 3 and -1 / 3.
  static constexpr std::array<double, stages> error{-10.048809399827416, 1.3821427331607488, -1.0 / 3.0};
};

}  // namespace saltus::ode
