#include "saltus/pipeline/surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/surfaces/surface_functions.hpp"
#include "saltus/pipeline/level_curves.hpp"
#include "saltus/pipeline/recorded_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::pipeline {
namespace {

/// Room around the trajectory, as a fraction of its range: a surface beside it should be seen, too.
constexpr double box_margin = 0.25;

/// >= 0 on the part of the surface that is one.
double least_margin(const evaluation::SurfaceFunction& function, double t, const double* coordinates) {
  double least = 0.0;
  for (const auto& margin_of : function.within_values) least = std::min(least, margin_of(t, coordinates));
  return least;
}

/// The parts of a polyline along which `inside` is >= 0, cut to the last digits.
std::vector<Polyline> cut(const Polyline& curve, FunctionRef<double(double, double)> inside) {
  std::vector<Polyline> pieces;
  bool drawing = false;
  const auto add = [&](double x, double y) {
    if (!drawing) pieces.emplace_back();
    drawing = true;
    pieces.back().x.push_back(x);
    pieces.back().y.push_back(y);
  };
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const bool here = inside(curve.x[i], curve.y[i]) >= 0.0;
    if (i > 0 && here != drawing) {
      const auto along = [&](double part) {
        return std::array{curve.x[i - 1] + part * (curve.x[i] - curve.x[i - 1]),
                          curve.y[i - 1] + part * (curve.y[i] - curve.y[i - 1])};
      };
      const auto positive = [&](double part) { return inside(along(part)[0], along(part)[1]) >= 0.0; };
      const auto [x, y] = along(change_of_sign(positive));
      add(x, y);
    }
    if (here) add(curve.x[i], curve.y[i]);
    drawing = here;
  }
  return pieces;
}

/// Adds where the function is zero at one time.
void add_curves(const evaluation::SurfaceFunction& function, double t, const std::vector<Interval>& ranges,
                std::vector<result::SurfaceCurve>& curves) {
  const auto when = function.depends_on_time ? std::optional<double>(t) : std::nullopt;
  if (ranges.size() == 1) {
    for (const double x : sign_changes([&](double value) { return function.value(t, &value); }, ranges[0])) {
      if (least_margin(function, t, &x) >= 0.0) curves.push_back({{{x}}, when});
    }
    return;
  }
  const auto value = [&](double x, double y) { return function.value(t, std::array{x, y}.data()); };
  const auto inside = [&](double x, double y) { return least_margin(function, t, std::array{x, y}.data()); };
  for (const auto& curve : level_curves(value, ranges[0], ranges[1])) {
    for (auto& piece : cut(curve, inside)) curves.push_back({{std::move(piece.x), std::move(piece.y)}, when});
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
  const double begin = result.passed_on              ? recorded<double>(result.options, "from").value_or(end)
                       : result.trajectory.t.empty() ? end
                                                     : result.trajectory.t.front();
  const int times = function.depends_on_time && begin < end ? times_of_moving_surface : 1;
  for (int i = 0; i < times; ++i) {
    add_curves(function, times == 1 ? end : begin + (end - begin) * i / (times - 1), ranges, curves);
  }
  return curves;
}

result::SurfaceRole role_of(evaluation::SurfaceOwner owner) {
  switch (owner) {
    case evaluation::SurfaceOwner::switching_function:
      return result::SurfaceRole::switching;
    case evaluation::SurfaceOwner::jump:
      return result::SurfaceRole::jump;
    case evaluation::SurfaceOwner::region_border:
      return result::SurfaceRole::region;
  }
  __builtin_unreachable();
}

result::AffineSurface form_of(const evaluation::AffineForm& form) { return {form.gradient, form.rate, form.constant}; }

}  // namespace

Interval drawn_range(const result::Result& result, int state) {
  const auto column = static_cast<std::size_t>(state);
  double least = result.final.x[column], greatest = least;
  const auto include = [&](double value) {
    // Negated, so that a range that begins with NaN takes the first number.
    if (!std::isfinite(value)) return;
    if (!(least <= value)) least = value;
    if (!(greatest >= value)) greatest = value;
  };
  if (result.passed_on) include(result.passed_on->least[column]), include(result.passed_on->greatest[column]);
  if (const auto in_rows = result::column_of_state(result, column)) {
    for (const auto& x : result.trajectory.x) include(x[*in_rows]);
  }
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    include(result.events.x(i)[column]);
    include(result.events.x_after(i)[column]);
  }
  const double width = greatest - least;
  const double room = width > 0.0 ? box_margin * width : std::max(0.5 * std::abs(least), 0.5);
  return {least - room, greatest + room};
}

std::vector<result::Surface> surfaces(const model::System& system, const result::Result& result) {
  std::vector<result::Surface> surfaces;
  int with_curves = 0;
  const auto is_hidden = [&](int state) { return at(state) >= result.states.size(); };
  for (const auto& function : evaluation::surface_functions(system)) {
    // The depth in an elastic contact is a state of the frozen system, and none of the result.
    if (std::any_of(function.states.begin(), function.states.end(), is_hidden)) continue;
    result::Surface surface;
    surface.name = function.name;
    surface.role = role_of(function.owner);
    surface.depends_on_time = function.depends_on_time;
    for (const int state : function.states) surface.states.push_back(result.states[at(state)]);
    if (function.affine) {
      surface.affine = form_of(*function.affine);
      for (const auto& form : function.within) surface.within.push_back(form_of(form));
    } else if (function.value && with_curves < most_surfaces_with_curves) {
      surface.curves = curves_of(function, result);
      ++with_curves;
      // Two of many regions have no border, or none in the picture.
      if (surface.role == result::SurfaceRole::region && surface.curves.empty()) continue;
    }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace saltus::pipeline
