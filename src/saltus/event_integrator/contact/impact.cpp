#include "saltus/event_integrator/contact/impact.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/contact/impact_process_internal.hpp"

namespace saltus::event_integrator {

using linalg::Vector;

namespace {
constexpr double roundings = 64.0;  ///< in sums over the others
}  // namespace

std::optional<Vector> impact(const ContactPoint& point, const std::vector<int>& touching, std::optional<int> pushed) {
  Vector impulses = Vector::zero(point.velocity.size());
  if (touching.size() == 1 && point.friction[at(touching.front())] == 0.0) {
    const int i = touching.front();
    impulses(i) = -(1.0 + point.restitution[at(i)]) * point.velocity(i) / point.influence(i, i);
    return impulses;
  }
  double size = 0.0;
  for (const int i : touching) {
    size = std::max({size, std::abs(point.velocity(i)), point.along(point.velocity, i).norm()});
  }
  for (const auto& part : parts_of(point, touching)) {
    // What closes by the rounding of the others does not.
    const bool hits = std::any_of(part.begin(), part.end(), [&](int i) {
      return i == pushed || point.velocity(i) < -roundings * rounding_unit * size;
    });
    if (!hits) continue;
    const auto place = pushed ? std::find(part.begin(), part.end(), *pushed) : part.end();
    const auto own = place != part.end() ? std::optional(static_cast<int>(place - part.begin())) : std::nullopt;
    const auto found = impact_of_all(point_of(point, part), own);
    if (!found) return std::nullopt;
    const auto rows = rows_of(point, part);
    for (std::size_t k = 0; k < rows.size(); ++k) impulses(rows[k]) = (*found)(index(k));
  }
  return impulses;
}

}  // namespace saltus::event_integrator
