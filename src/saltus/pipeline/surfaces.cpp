#include "saltus/pipeline/surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
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

/// Adds where the function is zero at one time.
void add_curves(const evaluation::SurfaceFunction& function, double t, const std::vector<Interval>& ranges,
                std::vector<result::SurfaceCurve>& curves) {
  const auto when = function.depends_on_time ? std::optional<double>(t) : std::nullopt;
  if (ranges.size() == 1) {
    for (const double x : sign_changes([&](double value) { return function.value(t, &value); }, ranges[0])) {
      curves.push_back({{{x}}, when});
    }
    return;
  }
  const auto value = [&](double x, double y) { return function.value(t, std::array{x, y}.data()); };
  for (auto& curve : level_curves(value, ranges[0], ranges[1])) {
    curves.push_back({{std::move(curve.x), std::move(curve.y)}, when});
  }
}

std::vector<result::SurfaceCurve> curves_of(const evaluation::SurfaceFunction& function, const result::Result& result) {
  std::vector<Interval> ranges;
  for (const int state : function.states) ranges.push_back(drawn_range(result, state));
  std::vector<result::SurfaceCurve> curves;
  for (const auto& [from, to] : ranges) {
    if (!std::isfinite(from) || !std::isfinite(to)) return curves;
  }
  const double end = result.final.t;
  const double begin = result.trajectory.t.empty() ? end : result.trajectory.t.front();
  const int times = function.depends_on_time && begin < end ? times_of_moving_surface : 1;
  for (int i = 0; i < times; ++i) {
    add_curves(function, times == 1 ? end : begin + (end - begin) * i / (times - 1), ranges, curves);
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
