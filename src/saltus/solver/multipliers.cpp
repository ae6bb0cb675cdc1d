#include "saltus/solver/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::solver {

void take_from_bounds(const RowMatrix& jacobian, int row, linalg::Vector& pressure, double& multiplier) {
  double share = std::numeric_limits<double>::infinity();
  for (const linalg::Entry entry : jacobian.along(row)) {
    if (entry.value != 0.0) share = std::min(share, pressure[entry.inner] / entry.value);
  }
  if (!std::isfinite(share)) return;
  for (const linalg::Entry entry : jacobian.along(row)) pressure[entry.inner] -= share * entry.value;
  multiplier += share;
}

}  // namespace saltus::solver
