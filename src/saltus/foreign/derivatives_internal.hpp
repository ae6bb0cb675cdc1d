// Derivatives of foreign expressions, dense ones among them.
#pragma once

#include <casadi/core/sx.hpp>

namespace saltus::foreign {

/// Returns dc/dw. Rows that are affine in w are differentiated by numbers: graphs of dense rows are large.
[[nodiscard]] casadi::SX jacobian_of(const casadi::SX& c, const casadi::SX& w);

/// Returns the lower triangle of the second derivatives of factor f + y'c with respect to w. Those of affine rows are
/// left out, those of an f that is quadratic in w are numbers.
[[nodiscard]] casadi::SX hessian_of(const casadi::SX& f, const casadi::SX& c, const casadi::SX& w,
                                    const casadi::SX& factor, const casadi::SX& y);

}  // namespace saltus::foreign
