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

/// What follows sliding whose selection was lost at `lost_at`; nullopt where the sides say it.
std::optional<SurfaceDecision> behind_sliding(const SurfaceSituation& s, FunctionRef<double(double)> g,
                                              double lost_at) {
  if (lost_at > 0.0 && lost_at < 1.0) {
    const double beside = 1e-3;  // past the double zero, whose own sign is rounding
    const Drift direction = g(lost_at + beside) + g(lost_at - beside) > 0.0 ? Drift::up : Drift::down;
    return follow(g, lost_at + (direction == Drift::up ? beside : -beside), direction);
  }
  if (lost_at <= 0.0 && s.below.drift == Drift::down)
    return SurfaceDecision{Verdict::decided, -1, 0.0, {}, "the field below leaves the surface"};
  if (lost_at >= 1.0 && s.above.drift == Drift::up)
    return SurfaceDecision{Verdict::decided, +1, 1.0, {}, "the field above leaves the surface"};
  return std::nullopt;
}

/// What follows by where the fields of the sides go.
SurfaceDecision by_sides(const SurfaceSituation& s, FunctionRef<double(double)> g) {
  const bool leaves_below = s.below.drift == Drift::down;
  const bool leaves_above = s.above.drift == Drift::up;
  if (s.arrival == Arrival::from_below && !leaves_below) return follow(g, 0.0, Drift::up);
  if (s.arrival == Arrival::from_above && !leaves_above) return follow(g, 1.0, Drift::down);
  if (leaves_above && leaves_below) return {Verdict::decided, +1, 1.0, {}, "both fields point away: psi > 0 chosen"};
  return leaves_below ? follow(g, 1.0, Drift::down) : follow(g, 0.0, Drift::up);
}

}  // namespace

SurfaceDecision decide_selection(const SurfaceSituation& s, FunctionRef<double(double)> g, double lost_at) {
  if (s.below.drift == Drift::stays || s.above.drift == Drift::stays) return decide_surface(s);
  const auto behind = s.arrival == Arrival::along ? behind_sliding(s, g, lost_at) : std::nullopt;
  SurfaceDecision decision = behind ? *behind : by_sides(s, g);
  decision.other_modes = other_modes(s, g, decision);
  return decision;
}

}  // namespace saltus::switching
