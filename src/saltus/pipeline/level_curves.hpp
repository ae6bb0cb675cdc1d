// Where a function of one or two variables is zero, as points and polylines for a drawing.
#pragma once

#include <vector>

#include "saltus/base/function_ref.hpp"

namespace saltus::pipeline {

struct Interval {
  double from = 0.0;
  double to = 0.0;
};

struct Polyline {
  std::vector<double> x, y;
};

/// Samples per side of the grid on which changes of sign are looked for.
inline constexpr int level_curve_cells = 128;
/// Largest distance of a polyline from the curve, as a fraction of the box: a tenth of a pixel of a large drawing.
inline constexpr double level_curve_tolerance = 1e-4;

/// Finds the place between 0 and 1 where `inside`, which differs at both, changes, to the last digits.
[[nodiscard]] double change_of_sign(FunctionRef<bool(double)> inside);

/// Finds places in `range` where the sign of f changes, each to the last digits. f may jump there. Where f is not
/// finite nothing is looked for. Two changes within 1/2048 of the range are missed.
[[nodiscard]] std::vector<double> sign_changes(FunctionRef<double(double)> f, Interval range);

/// Finds the border between f > 0 and f <= 0 in the box x times y: marching squares, vertices by bisection on the edges
/// of the grid, bends between them refined to level_curve_tolerance. Pieces smaller than a cell are missed; a closed
/// piece ends in its first point. The order and direction of the pieces are those of the grid, the same in every run.
/// Cost: about level_curve_cells^2 evaluations and 60 for each vertex.
[[nodiscard]] std::vector<Polyline> level_curves(FunctionRef<double(double, double)> f, Interval x, Interval y);

}  // namespace saltus::pipeline
