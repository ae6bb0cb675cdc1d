#include "unresolved_events.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "random_systems_field.hpp"
#include "states.hpp"

namespace saltus::robustness {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The selections of the row with this time and mode; halves if there is none.
State selections_at(const result::Result& result, double t, const result::Mode& mode) {
  const auto& rows = result.trajectory;
  const auto first = std::lower_bound(rows.t.begin(), rows.t.end(), t);
  for (auto i = static_cast<std::size_t>(first - rows.t.begin()); i < rows.t.size() && rows.t[i] == t; ++i) {
    if (rows.mode[i] == mode) return rows.alpha[i];
  }
  return State(mode.size(), 0.5);
}

/// From x at t over h: less than 1e-9, so that second derivatives are lost in the rounding of x.
bool keeps_its_sides(const RandomSystem& system, const std::vector<bool>& listed, const result::Mode& mode,
                     const State& alpha, double t, double h, const State& x) {
  const OwnField field(system, mode);
  const State slope = field(t, x, alpha).xdot;
  double speed = 0.0;
  for (const double rate : slope) speed = std::max(speed, std::abs(rate));
  // Eight terms, each rounded once; an event is located to two units of t (Locator::time_resolution), and there are
  // two.
  const double rounding = 8.0 * epsilon * size_of(x) + 4.0 * epsilon * t * speed;
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    const auto value = field(t + part * h, moved(x, part * h, slope), alpha);
    for (std::size_t j = 0; j < mode.size(); ++j) {
      if (!listed[j] || field.is_read_anew(j)) continue;
      // As rows have them.
      if (mode[j] == 0 && !(value.alpha[j] >= -1e-9 && value.alpha[j] <= 1.0 + 1e-9)) return false;
      const double beyond = mode[j] == 0 ? std::abs(value.psi[j]) : -mode[j] * value.psi[j];
      if (!(beyond <= rounding)) return false;
    }
  }
  return true;
}

}  // namespace

bool is_unresolved(const RandomSystem& system, const std::vector<bool>& listed, const result::Result& result,
                   std::size_t first, std::size_t second) {
  const std::vector<result::Event> events = result.events;
  const auto keeps = [&](const result::Mode& mode, double t_of_row, double t, double until, const State& x) {
    return keeps_its_sides(system, listed, mode, selections_at(result, t_of_row, mode), t, until - t, x);
  };
  for (std::size_t k = second; k-- > 0 && events[second].t - events[k].t < 1e-9;) {
    const bool same =
        events[k].mode_before == events[second].mode_before && events[k].mode_after == events[second].mode_after;
    if (same) return false;
  }
  for (std::size_t k = first; k < second; ++k) {
    if (!keeps(*events[k].mode_after, events[k].t, events[k].t, events[k + 1].t, events[k].x_after)) return false;
  }
  const auto& a = events[first];
  const auto& b = events[second];
  return keeps(*a.mode_before, a.t, a.t, b.t, a.x) || keeps(*b.mode_after, b.t, a.t, b.t, a.x_after);
}

}  // namespace saltus::robustness
