#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <casadi/core/dm.hpp>
#include <casadi/core/function.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/base/at.hpp"
#include "saltus/foreign/row_ranges_internal.hpp"

namespace saltus::foreign {
namespace {

std::vector<double> at_zero(const casadi::SX& w, const casadi::SX& rows) {
  const casadi::Function value("rows", {w}, {rows});
  return value(std::vector<casadi::DM>{casadi::DM::zeros(w.numel())}).front().get_elements();
}

/// NaN where it is not constant.
double coefficient_of(const casadi::SXElem& entry) {
  return entry.is_constant() ? static_cast<double>(entry) : std::nan("");
}

}  // namespace

mpcc::Bounds with_rows_of_one_variable(const casadi::SX& w, const casadi::SX& rows, const casadi::SX& jacobian,
                                       mpcc::Bounds bounds, const mpcc::Bounds& of_rows) {
  const auto constants = at_zero(w, rows);
  const auto places = jacobian.sparsity().get_row(), columns = jacobian.sparsity().get_col();
  std::vector<int> entries(constants.size(), 0);
  for (const auto row : places) ++entries[at(row)];
  for (std::size_t e = 0; e < places.size(); ++e) {
    const auto row = places[e];
    const double a = coefficient_of(jacobian.nonzeros()[e]);
    if (row >= of_rows.lower.size() || entries[at(row)] != 1 || !(std::abs(a) > 0.0)) continue;
    const double one = (of_rows.lower[row] - constants[at(row)]) / a,
                 other = (of_rows.upper[row] - constants[at(row)]) / a;
    auto& [lower, upper] = bounds;
    lower[columns[e]] = std::max(lower[columns[e]], std::min(one, other));
    upper[columns[e]] = std::min(upper[columns[e]], std::max(one, other));
  }
  return bounds;
}

mpcc::Bounds ranges_of(const casadi::SX& w, const casadi::SX& rows, const casadi::SX& jacobian,
                       const mpcc::Bounds& bounds) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const auto constants = at_zero(w, rows);
  mpcc::Bounds ranges{linalg::ConstView(constants), linalg::ConstView(constants)};
  const auto places = jacobian.sparsity().get_row(), columns = jacobian.sparsity().get_col();
  for (std::size_t e = 0; e < places.size(); ++e) {
    const auto row = places[e];
    const double a = coefficient_of(jacobian.nonzeros()[e]);
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
