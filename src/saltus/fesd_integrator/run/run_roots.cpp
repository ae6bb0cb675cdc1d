// Elements that begin or end where a root is zero.
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {

/// A root of the field at a point, with d base/dt, the sum of the sizes of its terms, and of the gradient of the base.
struct Run::Root {
  std::size_t number = 0;
  double exponent = 1.0, base = 0.0;
  double rate = 0.0, terms = 0.0, gradient = 0.0;
};

/// Calls `take(root)` for the roots that the field of the mode at hand has at a point.
template <class Take>
void Run::for_each_root(double t, const double* x, Take&& take) {
  const auto& exponents = kernel_.root_exponents();
  zero_roots_.assign(exponents.size(), 0.0);
  kernel_.evaluate(t, x, selections_.data(), held_.data(), zero_roots_.data(), at_switch_, at_roots_);
  const std::size_t n_x = x_.size(), n = exponents.size();
  for (std::size_t k = 0; k < n; ++k) {
    bool acts = false;
    Root root{k, exponents[k], at_roots_.base[k]};
    for (std::size_t i = 0; i < n_x; ++i) {
      acts = acts || at_roots_.f_root[k * n_x + i] != 0.0;
      const double term = at_roots_.base_x[i * n + k] * at_switch_.f[i];
      root.rate += term;
      root.terms += std::abs(term);
      root.gradient += std::abs(at_roots_.base_x[i * n + k]);
    }
    if (acts) take(root);
  }
}

int Run::warp_behind(double h) {
  int warp = 1;
  if (kernel_.root_exponents().empty()) return warp;
  std::vector<Root> zeros;
  for_each_root(t_, x_.data(), [&](const Root& root) {
    constexpr double near = 1e-9;  // of the element
    constexpr double roundings = 64.0 * std::numeric_limits<double>::epsilon();
    if (std::abs(root.base) <= near * h * root.terms + roundings * root.gradient * size_) zeros.push_back(root);
  });
  if (zeros.empty()) return warp;
  // A base that leaves zero like t^2 has a root like t^(2 c).
  constexpr double ahead = 1e-2, tangent = 1e-6;
  std::vector<double> x = x_;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += ahead * h * at_switch_.f[i];
  std::vector<double> rates(kernel_.root_exponents().size());
  for_each_root(t_ + ahead * h, x.data(), [&](const Root& root) { rates[root.number] = root.rate; });
  const int most = most_warped(solver_.tableau().stages());
  for (const Root& root : zeros) {
    const bool bends = std::abs(root.rate) <= tangent * std::abs(rates[root.number]);
    const double exponent = bends ? 2.0 * root.exponent : root.exponent;
    if (exponent != std::round(exponent)) warp = std::max(warp, warp_for(exponent, most));
  }
  return warp;
}

int Run::warp_before(const Element& beyond) {
  int warp = 1;
  if (kernel_.root_exponents().empty()) return warp;
  const int most = most_warped(solver_.tableau().stages());
  for_each_root(beyond.t + beyond.h, beyond.end.data(), [&](const Root& root) {
    if (root.base < 0.0) warp = std::max(warp, warp_for(root.exponent, most));
  });
  return warp;
}

}  // namespace saltus::fesd_integrator
