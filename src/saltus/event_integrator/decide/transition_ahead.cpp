// Where the motion of a mode goes from a point at which no derivative decides: by short steps along its own field.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/ode/explicit/classical_step.hpp"

namespace saltus::event_integrator {
namespace {

/// The event functions at four points over a hundredth of the time scale, by Runge-Kutta steps, as long as `look`
/// returns true; whether it always did.
template <class Look>
bool follow_fast(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point,
                 const std::vector<double>& start, const Look& look) {
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(state);
  std::vector<double> x = start, psi(at(s.kernel.event_functions()));
  ode::ClassicalStep classical(start.size());
  constexpr int steps = 4;
  const double h = look_ahead(switching_point.time_scale) / steps;
  double t = switching_point.t;
  const auto along = [&](double time, const double* point, double* slope) { field(time, point, slope); };
  for (int step = 0; step < steps; ++step) {
    classical.take(along, t, h, x);
    t += h;
    s.kernel.functions(t, x.data(), state.alpha.data(), psi.data());
    if (!look(psi)) return false;
  }
  return true;
}

}  // namespace

bool leads_into_its_region(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point,
                           const std::vector<double>& start, const std::vector<int>& surfaces) {
  return follow_fast(s, state, switching_point, start, [&](const std::vector<double>& psi) {
    return std::all_of(surfaces.begin(), surfaces.end(), [&](int j) { return psi[at(j)] * state.mode[at(j)] > 0.0; });
  });
}

int side_ahead(const SwitchingContext& s, const ModeState& state, const SwitchingPoint& switching_point,
               const std::vector<double>& start, int function) {
  int side = 0;
  const bool one_side = follow_fast(s, state, switching_point, start, [&](const std::vector<double>& psi) {
    const double value = psi[at(function)];
    const int here = value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
    if (side == 0) side = here;
    return here != 0 && here == side;
  });
  return one_side ? side : 0;
}

}  // namespace saltus::event_integrator
