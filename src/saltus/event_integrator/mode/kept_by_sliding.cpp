#include "saltus/event_integrator/mode/kept_by_sliding.hpp"

#include <vector>

#include <Eigen/Core>

namespace saltus::event_integrator {

bool is_kept_by_sliding(const evaluation::ModelKernel& kernel, const ModeState& state, int function, double t,
                        const double* x) {
  constexpr double none = 1e-10;
  if (state.sliding.empty()) return false;
  const auto gradient = [&](int of) {
    Eigen::VectorXd row(kernel.states() + 1);
    kernel.gradient(of, t, x, state.alpha.data(), row.data(), row.data() + kernel.states());
    return row;
  };
  Eigen::VectorXd left = gradient(function);
  const Eigen::VectorXd whole = left;
  std::vector<Eigen::VectorXd> basis;
  for (const int surface : state.sliding) {
    Eigen::VectorXd row = gradient(surface);
    const double size = row.norm();
    if (!(row.cwiseProduct(whole).cwiseAbs().maxCoeff() > 0.0)) continue;
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
