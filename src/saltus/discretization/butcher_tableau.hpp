// Runge-Kutta methods: the coefficients of one element's discretisation.
#pragma once

#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/discretization/fesd_options.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::discretization {

/// Returns the name of a family in model files.
[[nodiscard]] std::string_view name(TableauFamily family);

/// Holds x_1 = x_0 + h sum_i b_i k_i,   k_i = f(t_0 + c_i h, x_0 + h sum_j a_ij k_j)   (eq. (33) of [nurkanovic2024]).
struct ButcherTableau {
  TableauFamily family = TableauFamily::radau_iia;
  int order = 0;
  linalg::Matrix A;  ///< s x s
  linalg::Vector b;  ///< s
  linalg::Vector c;  ///< s, ascending

  [[nodiscard]] int stages() const { return static_cast<int>(b.size()); }
  /// Returns whether the method is stiffly accurate: the last stage is the end of the step, c_s = 1 and a_sj = b_j.
  [[nodiscard]] bool ends_at_last_stage() const;
  /// Returns whether the stages are values of a polynomial of degree s: all families but Lobatto IIIC and the explicit
  /// methods.
  [[nodiscard]] bool is_collocation() const;
};

/// Returns the tableau of so many stages; coefficients correct to rounding: the nodes are roots of Legendre polynomials
/// and their relatives by Newton's method in extended precision, A = (integral from 0 to c_i of the j-th Lagrange
/// polynomial) by a quadrature that is exact for it. Fails with `invalid_option` for a number of stages that the family
/// does not have. Cost: s^4. Source: [hairer1996], sections IV.5 and IV.12.
[[nodiscard]] Expected<ButcherTableau> butcher_tableau(TableauFamily family, int stages);

}  // namespace saltus::discretization
