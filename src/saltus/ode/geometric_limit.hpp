// Where a sequence goes whose differences shrink geometrically.
#pragma once

#include <cmath>

namespace saltus::ode {

/// Holds three successive terms of a sequence.
struct SuccessiveTerms {
  double first = 0.0, second = 0.0, third = 0.0;
};

/// Does Aitken's delta-squared process: the limit x_3 + d_2^2 / (d_1 - d_2), d_k = x_(k+1) - x_k, which is exact for
/// geometric sequences of any ratio below 1.
/// @param ratio  r < 1, by which the whole shrinks that x is a component of. Where |d_2| > (1 + r) / 2 |d_1| the
///               differences are rounding, and the limit is x_3.
[[nodiscard]] inline double geometric_limit(const SuccessiveTerms& x, double ratio) {
  const double last = x.third - x.second;
  const double before = x.second - x.first;
  if (!(std::abs(last) <= 0.5 * (1.0 + ratio) * std::abs(before)) || last == 0.0) return x.third;
  return x.third + last * last / (before - last);
}

}  // namespace saltus::ode
