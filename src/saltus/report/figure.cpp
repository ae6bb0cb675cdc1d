#include "saltus/report/figure.hpp"

#include <algorithm>
#include <deque>
#include <iterator>

#include <fmt/format.h>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/result/drawn.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::report {
namespace {

const FigureColumn* named(const std::vector<FigureColumn>& columns, const std::string& name) {
  const auto found =
      std::find_if(columns.begin(), columns.end(), [&](const auto& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

Error unknown_column(const std::vector<FigureColumn>& columns, const std::string& option, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& column : columns) known.push_back(column.name);
  return {ErrorCode::unknown_name,
          fmt::format("{}: the result has no column '{}'", option, name),
          suggest(name, known),
          {},
          {}};
}

/// The other results, in the pens of the page.
/// @param redrawn  keeps those that are drawn otherwise than they are stored
FigureOverlays figure_overlays(const std::vector<Overlay>& overlays, std::deque<result::Result>& redrawn) {
  constexpr std::string_view dashes[] = {"", "7 4", "2 3", "7 3 2 3"};
  FigureOverlays others;
  for (const auto& [label, stored] : overlays) {
    const std::size_t i = others.size(), colors = paper::overlays.size();
    auto drawn = as_drawn(stored);
    const auto& result = drawn ? redrawn.emplace_back(std::move(*drawn)) : stored;
    const Pen pen{paper::overlays[i % colors], 1.5, dashes[i / colors % std::size(dashes)]};
    others.push_back({label, result, figure_columns(result), pen});
  }
  return others;
}

}  // namespace

Expected<std::vector<std::string>> figure_names(const result::Result& result, const std::string& text) {
  if (result.kept) return figure_names(as_in_rows(result), text);
  auto columns = figure_columns(result);
  columns.pop_back();  // the time is the axis
  std::vector<std::string> names;
  for (std::size_t at = 0; at <= text.size();) {
    // Names may contain commas: the longest one that there is.
    std::size_t end = text.size();
    while (end != std::string::npos && end > at && named(columns, text.substr(at, end - at)) == nullptr) {
      end = text.rfind(',', end - 1);
      if (end != std::string::npos && end < at) end = std::string::npos;
    }
    if (end == std::string::npos || end <= at) {
      return tl::unexpected(unknown_column(columns, "--columns", text.substr(at, text.find(',', at) - at)));
    }
    names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

Expected<PhaseAxes> phase_axes(const result::Result& result, const std::string& text) {
  if (result.kept) return phase_axes(as_in_rows(result), text);
  const auto columns = figure_columns(result);
  const auto first = text.find(',');
  if (first == std::string::npos) {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("--phase '{}': two columns are needed", text),
                                "write them as X,Y",
                                {},
                                {}});
  }
  for (auto comma = first; comma != std::string::npos; comma = text.find(',', comma + 1)) {
    PhaseAxes axes{text.substr(0, comma), text.substr(comma + 1)};
    if (named(columns, axes.first) != nullptr && named(columns, axes.second) != nullptr) return axes;
  }
  const bool known = named(columns, text.substr(0, first)) != nullptr;
  return tl::unexpected(unknown_column(columns, "--phase", known ? text.substr(first + 1) : text.substr(0, first)));
}

Expected<std::string> to_svg(const result::Result& result, const std::optional<PhaseAxes>& phase,
                             const std::vector<std::string>& names, const std::vector<Overlay>& overlays) {
  if (const auto drawn = as_drawn(result)) return to_svg(*drawn, phase, names, overlays);
  std::deque<result::Result> redrawn;
  const auto others = figure_overlays(overlays, redrawn);
  const auto columns = figure_columns(result);
  if (!phase) {
    std::vector<FigureColumn> chosen;
    for (const auto& name : names) {
      if (named(columns, name) == nullptr) return tl::unexpected(unknown_column(columns, "--columns", name));
      chosen.push_back(*named(columns, name));
    }
    return draw_over_time(result, chosen, others);
  }
  for (const auto& name : {phase->first, phase->second}) {
    if (named(columns, name) == nullptr) return tl::unexpected(unknown_column(columns, "--phase", name));
  }
  return draw_in_a_plane(result, *named(columns, phase->first), *named(columns, phase->second), others);
}

}  // namespace saltus::report
