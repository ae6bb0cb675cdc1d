// A hysteresis as four regions in the plane of its input and its state.
#include <utility>

#include "saltus/model/time_freezing/freeze_internal.hpp"

namespace saltus::model {

using casadi::SX;

namespace {

/// Squared distance to one of the four points whose nearest ones make the regions.
SX distance(const HysteresisPlane& plane, double scaled, double value) {
  return (plane.scaled - scaled) * (plane.scaled - scaled) + (plane.value - value) * (plane.value - value);
}

SXElem entry(const SX& expression) { return SX::densify(expression).scalar(); }

}  // namespace

/// NOTE: rates do not vanish at the thresholds: where they did nothing would determine the weights of the regions, and
/// an optimiser uses that.
void freeze_in_plane(Statement& statement, const FreezingPlan& plan) {
  const auto& plane = *plan.plane;
  const double up = plan.numbers.transfer;
  // On a line where it waits half of the field is that of the auxiliary region, which stands still.
  const auto twice = [&](double side, double rate) {
    std::vector<ModeRate> rates;
    for (int i = 0; i < plan.made.first_hidden; ++i) {
      const auto& state = statement.states[at(i)];
      if (i == plane.state || !state.dynamics) continue;
      rates.push_back(
          {i, entry(2.0 * SX::substitute(SX(*state.dynamics), plane.value, side)), state.dynamics_location});
    }
    rates.push_back({plane.state, SXElem(rate), {}});
    rates.push_back({plan.made.clock, SXElem(2.0), {}});
    return rates;
  };
  ModeGroupStatement group{plane.name + ".transfer", {}};
  const auto add = [&](const char* name, const SX& indicator, std::vector<ModeRate> rates) {
    ModeStatement mode;
    mode.indicator = entry(indicator);
    mode.name = plane.name + name;
    mode.rates = std::move(rates);
    group.modes.push_back(std::move(mode));
  };
  add(".below", distance(plane, 0.25, -0.25), twice(0.0, up));
  add(".down", distance(plane, 0.25, 0.25), {{plane.state, SXElem(-up), {}}});
  add(".up", distance(plane, 0.75, 0.75), {{plane.state, SXElem(up), {}}});
  add(".above", distance(plane, 0.75, 1.25), twice(1.0, -up));
  for (int i = 0; i < plan.made.first_hidden; ++i) {
    auto& state = statement.states[at(i)];
    if (state.dynamics) state.dynamics = SXElem(0.0);
  }
  statement.mode_groups.push_back(std::move(group));
  statement.time = plan.numerical_time;
  statement.automatic_outputs.push_back({"clock_rate", SXElem(1.0)});
}

}  // namespace saltus::model
