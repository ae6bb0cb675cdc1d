#include "saltus/event_integrator/mode/kept_by_sliding.hpp"

#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

bool is_kept_by_sliding(const evaluation::ModelKernel& kernel, const ModeState& state, int function, double t,
                        const double* x) {
  constexpr double none = 1e-10;
  if (state.sliding.empty()) return false;
  const auto gradient = [&](int of) {
    linalg::Vector row(kernel.states() + 1);
    kernel.gradient(of, t, x, state.alpha.data(), row.data(), row.data() + kernel.states());
    return row;
  };
  linalg::Vector left = gradient(function);
  const linalg::Vector whole = left;
  std::vector<linalg::Vector> basis;
  for (const int surface : state.sliding) {
    linalg::Vector row = gradient(surface);
    const double size = row.norm();
    if (!(row.times_each(whole).max_abs() > 0.0)) continue;
    for (int pass = 0; pass < 2; ++pass) {
      for (const auto& before : basis) row -= before.dot(row) * before;
    }
    if (!(row.norm() > none * size)) continue;
    basis.push_back(row.normalized());
    left -= basis.back().dot(left) * basis.back();
  }
  return left.norm() <= none * whole.norm();
}

}  // namespace saltus::event_integrator
