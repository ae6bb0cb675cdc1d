#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/fesd_integrator/run/root_warps_internal.hpp"

namespace saltus::fesd_integrator {

RootWarps::RootWarps(const RunContext& context, const Position& position) : context_(context), position_(position) {
  context.kernel.size(values_);
  context.kernel.size(roots_);
}

/// A root of the field at a point. It has d base/dt, the sum of the sizes of its terms, and that of the gradient of the
/// base.
struct RootWarps::Root {
  std::size_t number = 0;
  double exponent = 1.0, base = 0.0;
  double rate = 0.0, terms = 0.0, gradient = 0.0;
};

/// Calls `take(root)` for the roots that the field of the current mode has at a point.
template <class Take>
void RootWarps::for_each_root(double t, const double* x, Take&& take) {
  const auto& exponents = context_.kernel.root_exponents();
  zero_roots_.assign(exponents.size(), 0.0);
  context_.kernel.evaluate(t, x, position_.selections().data(), context_.held.data(), zero_roots_.data(), values_,
                           roots_);
  const std::size_t n_x = position_.x().size(), n = exponents.size();
  for (std::size_t k = 0; k < n; ++k) {
    bool acts = false;
    Root root{k, exponents[k], roots_.base[k]};
    for (std::size_t i = 0; i < n_x; ++i) {
      acts = acts || roots_.f_root[k * n_x + i] != 0.0;
      const double term = roots_.base_x[i * n + k] * values_.f[i];
      root.rate += term;
      root.terms += std::abs(term);
      root.gradient += std::abs(roots_.base_x[i * n + k]);
    }
    if (acts) take(root);
  }
}

int RootWarps::behind(double h) {
  int warp = 1;
  if (context_.kernel.root_exponents().empty()) return warp;
  std::vector<Root> zeros;
  for_each_root(position_.t(), position_.x().data(), [&](const Root& root) {
    constexpr double near = 1e-9;  // of the element
    constexpr double roundings = 64.0 * std::numeric_limits<double>::epsilon();
    if (std::abs(root.base) <= near * h * root.terms + roundings * root.gradient * position_.size())
      zeros.push_back(root);
  });
  if (zeros.empty()) return warp;
  // A base that leaves zero like t^2 has a root like t^(2 c).
  constexpr double ahead = 1e-2, tangent = 1e-6;
  std::vector<double> x = position_.x();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += ahead * h * values_.f[i];
  std::vector<double> rates(context_.kernel.root_exponents().size());
  for_each_root(position_.t() + ahead * h, x.data(), [&](const Root& root) { rates[root.number] = root.rate; });
  const int most = most_warped(context_.solver.tableau().stages());
  for (const Root& root : zeros) {
    const bool bends = std::abs(root.rate) <= tangent * std::abs(rates[root.number]);
    const double exponent = bends ? 2.0 * root.exponent : root.exponent;
    if (exponent != std::round(exponent)) warp = std::max(warp, warp_for(exponent, most));
  }
  return warp;
}

int RootWarps::before(const Element& beyond) {
  int warp = 1;
  if (context_.kernel.root_exponents().empty()) return warp;
  const int most = most_warped(context_.solver.tableau().stages());
  for_each_root(beyond.t + beyond.h, beyond.end.data(), [&](const Root& root) {
    if (root.base < 0.0) warp = std::max(warp, warp_for(root.exponent, most));
  });
  return warp;
}

}  // namespace saltus::fesd_integrator
