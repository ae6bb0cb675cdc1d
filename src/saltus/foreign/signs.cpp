#include <cmath>

#include <casadi/core/dm.hpp>
#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/foreign/signs_internal.hpp"

namespace saltus::foreign {
namespace {

/// What is known of one side while its entries are looked at.
struct Distances {
  bool are_finite = true;  ///< all coefficients constant, all bounds they point to finite
  double at_bounds = 0.0;  ///< linear part where every distance is zero
  double size = 0.0;       ///< sum of |terms|, for rounding errors
};

}  // namespace

std::vector<mpcc::Sign> signs_of(const casadi::SX& w, const casadi::SX& sides, const casadi::SX& jacobian,
                                 const mpcc::Bounds& bounds) {
  const auto n = at(sides.numel());
  std::vector<Distances> distances(n);
  const auto rows = jacobian.sparsity().get_row(), columns = jacobian.sparsity().get_col();
  for (std::size_t e = 0; e < rows.size(); ++e) {
    auto& side = distances[at(rows[e])];
    const auto& coefficient = jacobian.nonzeros()[e];
    if (!coefficient.is_constant()) {
      side.are_finite = false;
      continue;
    }
    const auto a = static_cast<double>(coefficient);
    if (a == 0.0) continue;
    const double bound = a > 0.0 ? bounds.lower[columns[e]] : bounds.upper[columns[e]];
    side.are_finite = side.are_finite && std::isfinite(bound) && std::isfinite(a);
    side.at_bounds += a * bound;
    side.size += std::abs(a * bound);
  }
  const casadi::Function value("sides", {w}, {sides});
  const auto at_zero = value(std::vector<casadi::DM>{casadi::DM::zeros(w.numel())}).front().get_elements();
  std::vector<mpcc::Sign> signs;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& side = distances[i];
    const double size = side.size + std::abs(at_zero[i]);
    // What a handful of additions may lose; a constant above would keep the side from ever being zero.
    const bool vanishes = std::abs(at_zero[i] + side.at_bounds) <= 8.0 * rounding_unit * size;
    signs.push_back(side.are_finite && vanishes ? mpcc::Sign::implied : mpcc::Sign::constrained);
  }
  return signs;
}

}  // namespace saltus::foreign
