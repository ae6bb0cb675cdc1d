// Elements that begin or end where a root is zero.
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/fesd_integrator/run_internal.hpp"

namespace saltus::fesd_integrator {

/// Calls `take(k, base, terms)` for the roots that the field of the mode at hand has at a point; `terms`: of d base /
/// dt.
template <class Take>
void Run::for_each_root(double t, const double* x, Take&& take) {
  const auto& exponents = kernel_.root_exponents();
  zero_roots_.assign(exponents.size(), 0.0);
  kernel_.evaluate(t, x, selections_.data(), held_.data(), zero_roots_.data(), at_switch_, at_roots_);
  const std::size_t n_x = x_.size(), n = exponents.size();
  for (std::size_t k = 0; k < n; ++k) {
    bool acts = false;
    double rate = 0.0, gradient = 0.0;
    for (std::size_t i = 0; i < n_x; ++i) {
      acts = acts || at_roots_.f_root[k * n_x + i] != 0.0;
      rate += std::abs(at_roots_.base_x[i * n + k] * at_switch_.f[i]);
      gradient += std::abs(at_roots_.base_x[i * n + k]);
    }
    if (acts) take(exponents[k], at_roots_.base[k], rate, gradient);
  }
}

int Run::warp_behind(double h) {
  int warp = 1;
  if (kernel_.root_exponents().empty()) return warp;
  const int most = most_warped(solver_.tableau().stages());
  for_each_root(t_, x_.data(), [&](double exponent, double base, double rate, double gradient) {
    constexpr double near = 1e-9;  // of the element
    constexpr double roundings = 64.0 * std::numeric_limits<double>::epsilon();
    if (std::abs(base) <= near * h * rate + roundings * gradient * size_)
      warp = std::max(warp, warp_for(exponent, most));
  });
  return warp;
}

int Run::warp_before(const Element& beyond) {
  int warp = 1;
  if (kernel_.root_exponents().empty()) return warp;
  const int most = most_warped(solver_.tableau().stages());
  for_each_root(beyond.t + beyond.h, beyond.end.data(), [&](double exponent, double base, double, double) {
    if (base < 0.0) warp = std::max(warp, warp_for(exponent, most));
  });
  return warp;
}

}  // namespace saltus::fesd_integrator
