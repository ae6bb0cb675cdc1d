#include <algorithm>
#include <cmath>

#include "saltus/switching/hidden/rest_point_internal.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {

RestPoint::RestPoint(HiddenFace& face)
    : face_(face),
      root_(at(face.surfaces())),
      velocity_(at(face.surfaces())),
      derivatives_(at(face.surfaces() * face.surfaces())),
      jacobian_(at(face.surfaces() * face.surfaces())),
      step_(at(face.surfaces())) {}

std::span<const double> RestPoint::jacobian() const {
  const std::size_t n = face_.free().size();
  return std::span(jacobian_).first(n * n);
}

bool RestPoint::find(const std::vector<double>& u) {
  root_ = u;
  const auto& free = face_.free();
  const std::size_t n = free.size();
  LuFactors lu(static_cast<int>(n));
  double size = 0.0;
  for (int k = 0; k < 12; ++k) {
    face_.velocity(root_.data(), velocity_.data());
    face_.derivatives(root_.data(), velocity_.data(), derivatives_.data());
    for (std::size_t i = 0; i < n; ++i) {
      step_[i] = velocity_[at(free[i])];
      std::copy_n(derivatives_.begin() + static_cast<std::ptrdiff_t>(at(free[i]) * n), n,
                  jacobian_.begin() + static_cast<std::ptrdiff_t>(i * n));
    }
    if (!lu.factor(jacobian())) return false;
    lu.solve(step_.data());
    size = 0.0;
    for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::abs(step_[i]));
    if (!(size < 0.25)) return false;
    if (size < 1e-14) return true;
    for (std::size_t i = 0; i < n; ++i) root_[at(free[i])] -= step_[i];
  }
  return size < 1e-10;
}

bool RestPoint::attracts() {
  const std::size_t n = face_.free().size();
  double change = 0.0;
  for (std::size_t i = 0; i < n * n; ++i) {
    change += (jacobian_[i] - jacobian_here_[i]) * (jacobian_[i] - jacobian_here_[i]);
  }
  const double shift = 10.0 * std::sqrt(change);
  for (std::size_t i = 0; i < n; ++i) jacobian_[i * n + i] += shift;
  return is_hurwitz(jacobian(), static_cast<int>(n));
}

}  // namespace saltus::switching
