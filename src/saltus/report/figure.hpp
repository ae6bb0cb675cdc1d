// The drawing of a report as a file, without a browser.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Columns along the horizontal and the vertical axis: a state, control, output, `alpha(NAME)`, or `t`.
using PhaseAxes = std::pair<std::string, std::string>;

/// "X,Y" as two columns of the result (names may contain commas).
/// @return unknown_name, with the nearest names, if there are no two such columns.
[[nodiscard]] Expected<PhaseAxes> phase_axes(const result::Result& result, const std::string& text);

/// One SVG document, 960 by as many pixels as it needs: over time the events, the bands of modes and every column that
/// moves, discrete states last; with `phase` these two columns against each other, with the surfaces of their plane.
/// Curves are thinned to their extremes per pixel. Cost: O(rows * columns).
[[nodiscard]] Expected<std::string> to_svg(const result::Result& result, const std::optional<PhaseAxes>& phase = {});

}  // namespace saltus::report
