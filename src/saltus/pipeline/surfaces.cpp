#include "saltus/pipeline/surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "saltus/evaluation/surface_functions.hpp"
#include "saltus/pipeline/level_curves.hpp"

namespace saltus::pipeline {
namespace {

/// Room around the trajectory, as a fraction of its range: a surface beside it should be seen, too.
constexpr double margin = 0.25;

/// What a drawing of one state shows; a state that does not move gets room of its own size.
Interval drawn_range(const result::Result& result, int state) {
  const auto column = static_cast<std::size_t>(state);
  double least = result.final.x[column], greatest = least;
  const auto include = [&](const std::vector<double>& x) {
    const double value = x[column];
    // Negated, so that a range that begins with NaN takes the first number.
    if (!std::isfinite(value)) return;
    if (!(least <= value)) least = value;
    if (!(greatest >= value)) greatest = value;
  };
  for (const auto& x : result.trajectory.x) include(x);
  for (const auto& event : result.events) include(event.x), include(event.x_after);
  const double width = greatest - least;
  const double room = width > 0.0 ? margin * width : std::max(0.5 * std::abs(least), 0.5);
  return {least - room, greatest + room};
}

std::vector<result::SurfaceCurve> curves_of(const evaluation::SurfaceFunction& function, const result::Result& result) {
  std::vector<result::SurfaceCurve> curves;
  const Interval range = drawn_range(result, function.states[0]);
  if (!std::isfinite(range.from) || !std::isfinite(range.to)) return curves;
  if (function.states.size() == 1) {
    for (const double x : sign_changes([&](double value) { return function.value(&value); }, range)) {
      curves.push_back({{{x}}});
    }
    return curves;
  }
  const Interval other = drawn_range(result, function.states[1]);
  if (!std::isfinite(other.from) || !std::isfinite(other.to)) return curves;
  const auto value = [&](double x, double y) { return function.value(std::array{x, y}.data()); };
  for (auto& curve : level_curves(value, range, other)) {
    curves.push_back({{std::move(curve.x), std::move(curve.y)}});
  }
  return curves;
}

}  // namespace

std::vector<result::Surface> surfaces(const model::System& system, const result::Result& result) {
  std::vector<result::Surface> surfaces;
  int with_curves = 0;
  for (const auto& function : evaluation::surface_functions(system)) {
    result::Surface surface;
    surface.name = function.name;
    surface.role =
        function.owner == evaluation::SurfaceOwner::jump ? result::SurfaceRole::jump : result::SurfaceRole::switching;
    surface.depends_on_time = function.depends_on_time;
    for (const int state : function.states) surface.states.push_back(result.states[static_cast<std::size_t>(state)]);
    if (function.affine) {
      surface.affine = {function.affine->gradient, function.affine->rate, function.affine->constant};
    } else if (function.value && with_curves < most_surfaces_with_curves) {
      surface.curves = curves_of(function, result);
      ++with_curves;
    }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace saltus::pipeline
