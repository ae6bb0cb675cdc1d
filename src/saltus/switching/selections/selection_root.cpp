#include "saltus/switching/selections/selection_root.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace saltus::switching {
namespace {

constexpr int samples = 256;  // roots closer together than 1/256 are taken for none or one

double bisect(FunctionRef<double(double)> g, double inside, double beyond) {
  const double sign = g(inside);
  for (int i = 0; i < 200 && std::nextafter(inside, beyond) != beyond; ++i) {
    const double middle = 0.5 * (inside + beyond);
    if (middle == inside || middle == beyond) break;
    (g(middle) * sign > 0.0 ? inside : beyond) = middle;
  }
  return 0.5 * (inside + beyond);
}

/// First zero of g from `start` in the direction of its sign there.
std::optional<double> first_zero(FunctionRef<double(double)> g, double start, Drift direction) {
  const double sign = direction == Drift::up ? 1.0 : -1.0;
  const double end = direction == Drift::up ? 1.0 : 0.0;
  double previous = start;
  for (int i = 1; i <= samples; ++i) {
    const double next = start + (end - start) * i / samples;
    if (sign * g(next) < 0.0) return bisect(g, previous, next);
    previous = next;
  }
  return std::nullopt;
}

SurfaceDecision follow(FunctionRef<double(double)> g, double start, Drift direction) {
  if (const auto zero = first_zero(g, start, direction)) {
    return {Verdict::decided, 0, *zero, {}, "first zero of the normal component from the side of arrival: sliding"};
  }
  const int side = static_cast<int>(direction);
  return {Verdict::decided, side, side > 0 ? 1.0 : 0.0, {}, "no sliding selection in the direction of motion"};
}

/// Zeros at which g falls, besides the chosen one, and the sides that are left: Filippov's other continuations.
std::vector<int> other_modes(const SurfaceSituation& s, FunctionRef<double(double)> g, const SurfaceDecision& chosen) {
  std::vector<int> others;
  if (s.below.drift == Drift::down && chosen.mode != -1) others.push_back(-1);
  int zeros = 0;
  for (int i = 0; i < samples; ++i) {
    if (g(static_cast<double>(i) / samples) * g(static_cast<double>(i + 1) / samples) < 0.0) ++zeros;
  }
  if (zeros > (chosen.mode == 0 ? 1 : 0)) others.push_back(0);
  if (s.above.drift == Drift::up && chosen.mode != +1) others.push_back(+1);
  return others;
}

}  // namespace

SurfaceDecision decide_selection(const SurfaceSituation& s, FunctionRef<double(double)> g, double lost_at) {
  SurfaceDecision decision;
  const bool leaves_below = s.below.drift == Drift::down;
  const bool leaves_above = s.above.drift == Drift::up;
  if (s.below.drift == Drift::stays || s.above.drift == Drift::stays) return decide_surface(s);
  if (s.arrival == Arrival::from_below && !leaves_below) {
    decision = follow(g, 0.0, Drift::up);
  } else if (s.arrival == Arrival::from_above && !leaves_above) {
    decision = follow(g, 1.0, Drift::down);
  } else if (s.arrival == Arrival::along && lost_at > 0.0 && lost_at < 1.0) {
    const double beside = 1e-3;  // past the double zero, whose own sign is rounding
    const Drift direction = g(lost_at + beside) + g(lost_at - beside) > 0.0 ? Drift::up : Drift::down;
    decision = follow(g, lost_at + (direction == Drift::up ? beside : -beside), direction);
  } else if (s.arrival == Arrival::along && lost_at <= 0.0 && leaves_below) {
    decision = {Verdict::decided, -1, 0.0, {}, "the field below leaves the surface"};
  } else if (s.arrival == Arrival::along && lost_at >= 1.0 && leaves_above) {
    decision = {Verdict::decided, +1, 1.0, {}, "the field above leaves the surface"};
  } else if (leaves_above) {
    decision = leaves_below ? SurfaceDecision{Verdict::decided, +1, 1.0, {}, "both fields point away: psi > 0 chosen"}
                            : follow(g, 0.0, Drift::up);
  } else {
    decision = leaves_below ? follow(g, 1.0, Drift::down) : follow(g, 0.0, Drift::up);
  }
  decision.other_modes = other_modes(s, g, decision);
  return decision;
}

}  // namespace saltus::switching
