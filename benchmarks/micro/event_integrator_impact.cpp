// What does the resolution of an impact cost? Contacts of boxes: one without friction, one that slips and sticks, one
// with two tangents whose slip turns, four corners at once; and the comparison with one corner behind the other.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <benchmark/benchmark.h>

#include "saltus/event_integrator/contact/impact.hpp"
#include "saltus/event_integrator/contact/impact_orders.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;

/// Contacts of a body with 6 velocities (mass 1, moments of inertia 0.1) at points under it, 0.5 below its centre.
/// @param tangents  of each contact
ContactPoint body(int contacts, int tangents, double friction) {
  const int rows = contacts * (1 + std::max(tangents, 1));  // those of missing tangents are 0
  linalg::Matrix directions = linalg::Matrix::zero(rows, 6);
  for (int i = 0; i < contacts; ++i) {
    const double angle = 0.3 + 1.5707963267948966 * i;
    const double x = 0.4 * std::cos(angle), y = 0.4 * std::sin(angle), z = -0.5;
    const auto set = [&](int row, double nx, double ny, double nz) {
      directions.row(row) = {nx, ny, nz, y * nz - z * ny, z * nx - x * nz, x * ny - y * nx};
    };
    set(i, 0, 0, 1);
    if (tangents > 0) set(contacts + i, 1, 0, 0);
    if (tangents > 1) set(2 * contacts + i, 0, 1, 0);
  }
  const linalg::Vector inverse_mass{1.0, 1.0, 1.0, 10.0, 10.0, 10.0}, velocity{1.0, 0.2, -2.0, 0.3, -0.2, 0.1};
  const auto m = static_cast<std::size_t>(contacts);
  ContactPoint point;
  point.influence = linalg::scaled_cols(directions, inverse_mass) * directions.transpose();
  point.velocity = directions * velocity;
  point.acceleration = linalg::Vector::zero(rows);
  point.acceleration.head(contacts).set_constant(-9.81);
  point.terms = 9.81;
  point.friction.assign(m, friction);
  point.restitution.assign(m, 0.3);
  point.tangents.assign(m, tangents);
  point.has_gap.assign(m, true);
  return point;
}

void impacts(benchmark::State& state, int contacts, int tangents, double friction) {
  const ContactPoint point = body(contacts, tangents, friction);
  std::vector<int> touching;
  for (int i = 0; i < contacts; ++i) touching.push_back(i);
  if (!impact(point, touching)) state.SkipWithError("no impulses");
  for (auto _ : state) benchmark::DoNotOptimize(impact(point, touching));
}
void comparisons(benchmark::State& state, int contacts, int tangents, double friction) {
  const ContactPoint point = body(contacts, tangents, friction);
  std::vector<int> touching;
  for (int i = 0; i < contacts; ++i) touching.push_back(i);
  const auto impulses = impact(point, touching);
  if (!impulses || !find_other_end(point, touching, *impulses)) state.SkipWithError("no other end");
  for (auto _ : state) benchmark::DoNotOptimize(find_other_end(point, touching, *impulses));
}

BENCHMARK_CAPTURE(impacts, one_without_friction, 1, 0, 0.0);
BENCHMARK_CAPTURE(impacts, one_slips, 1, 1, 0.1);
BENCHMARK_CAPTURE(impacts, one_sticks, 1, 1, 1.0);
BENCHMARK_CAPTURE(impacts, one_in_a_plane, 1, 2, 0.3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(impacts, four_without_friction, 4, 0, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(impacts, four_with_friction, 4, 1, 0.3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(comparisons, two_without_friction, 2, 0, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(comparisons, four_without_friction, 4, 0, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(comparisons, four_with_friction, 4, 1, 0.3)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace saltus::event_integrator
