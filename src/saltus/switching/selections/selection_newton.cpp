#include "saltus/switching/selections/selection_newton.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/switching/table/newton_steps_internal.hpp"

namespace saltus::switching {

SelectionNewton::SelectionNewton(int surfaces, Interpolation interpolation)
    : surfaces_(surfaces),
      interpolation_(interpolation),
      lu_(surfaces),
      g_(static_cast<std::size_t>(surfaces)),
      step_(g_.size()),
      jacobian_(g_.size() * g_.size()),
      shifted_(g_.size()) {}

bool SelectionNewton::solve(ProjectedField g, double* alpha) {
  return follow_root(alpha, step_, [&] {
    g(alpha, g_.data());
    selection_jacobian(g, interpolation_, surfaces_, alpha, g_.data(), jacobian_.data(), shifted_.data());
    evaluations_ += surfaces_ + 1;
    if (!lu_.factor(jacobian_)) return false;
    std::copy(g_.begin(), g_.end(), step_.begin());
    lu_.solve(step_.data());
    return true;
  });
}

}  // namespace saltus::switching
