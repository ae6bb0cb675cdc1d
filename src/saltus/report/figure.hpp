// The drawing of a report as a file, without a browser.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/report/overlay.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Columns along the horizontal and the vertical axis: a state, control, output, `alpha(NAME)`, or `t`.
using PhaseAxes = std::pair<std::string, std::string>;

/// Reads "X,Y" as two columns of the result (names may contain commas).
/// @return unknown_name, with the nearest names, if there are no two such columns.
[[nodiscard]] Expected<PhaseAxes> phase_axes(const result::Result& result, const std::string& text);

/// Reads "X,Y,…" as columns of the result other than `t` (names may contain commas).
/// @return unknown_name, with the nearest names, if there is no such column.
[[nodiscard]] Expected<std::vector<std::string>> figure_names(const result::Result& result, const std::string& text);

/// Draws one SVG document, 960 by as many pixels as it needs: over time the events, the bands of modes and every column
/// that moves, as the page draws them, or the columns `names`; with `phase` these two columns against each other, with
/// the surfaces of their plane, its vector field and the events. Curves are thinned to their extremes per pixel; where
/// they chatter their envelope and mean are drawn. Over them lie the same columns of `overlays`. Cost: O(rows *
/// columns).
[[nodiscard]] Expected<std::string> to_svg(const result::Result& result, const std::optional<PhaseAxes>& phase = {},
                                           const std::vector<std::string>& names = {},
                                           const std::vector<Overlay>& overlays = {});

}  // namespace saltus::report
