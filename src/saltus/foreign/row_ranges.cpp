#include <cmath>
#include <limits>

#include <casadi/core/dm.hpp>
#include <casadi/core/function.hpp>

#include "saltus/base/at.hpp"
#include "saltus/foreign/row_ranges_internal.hpp"

namespace saltus::foreign {

mpcc::Bounds ranges_of(const casadi::SX& w, const casadi::SX& rows, const casadi::SX& jacobian,
                       const mpcc::Bounds& bounds) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const casadi::Function value("rows", {w}, {rows});
  const auto at_zero = value(std::vector<casadi::DM>{casadi::DM::zeros(w.numel())}).front().get_elements();
  mpcc::Bounds ranges{linalg::ConstView(at_zero), linalg::ConstView(at_zero)};
  const auto places = jacobian.sparsity().get_row(), columns = jacobian.sparsity().get_col();
  for (std::size_t e = 0; e < places.size(); ++e) {
    const auto row = places[e];
    const auto& coefficient = jacobian.nonzeros()[e];
    const double a = coefficient.is_constant() ? static_cast<double>(coefficient) : std::nan("");
    if (a == 0.0) continue;
    ranges.lower[row] += a * (a > 0.0 ? bounds.lower : bounds.upper)[columns[e]];
    ranges.upper[row] += a * (a > 0.0 ? bounds.upper : bounds.lower)[columns[e]];
  }
  for (linalg::Index row = 0; row < ranges.lower.size(); ++row) {
    if (std::isnan(ranges.lower[row])) ranges.lower[row] = -unknown;
    if (std::isnan(ranges.upper[row])) ranges.upper[row] = unknown;
  }
  return ranges;
}

}  // namespace saltus::foreign
