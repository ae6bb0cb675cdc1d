// Columns of a trajectory as a figure draws them.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/report/figure/svg_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

enum class ColumnSort { state, output, control, alpha, theta, time };

struct FigureColumn {
  std::string name;
  ColumnSort sort = ColumnSort::state;
  std::size_t index = 0;
  std::vector<double> values;
  result::Caption caption{};
};

/// Holds another result of the model that is drawn over the first one.
struct FigureOverlay {
  std::string label;
  const result::Result& result;
  std::vector<FigureColumn> columns;
  Pen pen;

  /// Returns what it has of a column of the first one; null if it has none of that name.
  [[nodiscard]] const FigureColumn* like(const FigureColumn& column) const;
};
using FigureOverlays = std::vector<FigureOverlay>;

/// Measures and colours that all drawings share: those of the page on paper.
namespace paper {
inline constexpr double width = 960.0, left = 70.0;
inline constexpr std::string_view sliding = "#ef7d00", minus = "#1f4e8c", plus = "#9cc9ee", jump = "#0b7285",
                                  alarm = "#c2185b", mark = "#8d97a5", axis = "#b9c0ca", text = "#1c2430",
                                  quiet = "#66707f";
inline constexpr std::array<std::string_view, 4> overlays{"#e8590c", "#0b7285", "#c2185b", "#2b8a3e"};
inline constexpr std::array<std::string_view, 6> curves{"#1f66b0", "#11806a", "#8a4fb0",
                                                        "#6b7400", "#5a6b7d", "#b03a5b"};
}  // namespace paper

/// Returns all columns of the trajectory and the time behind them; rows that are too short count as not a number.
[[nodiscard]] std::vector<FigureColumn> figure_columns(const result::Result& result);

/// Returns the name with its unit: "x [m]".
[[nodiscard]] std::string title_of(const FigureColumn& column);

/// Returns the least and greatest finite value; {0, 0} if there is none.
[[nodiscard]] Range range_of(const std::vector<double>& values);
/// Returns a range with a little room; one that is a point gets room of its own size.
[[nodiscard]] Range roomy(Range range);
/// Returns whether values change by more than rounding.
[[nodiscard]] bool moves(const std::vector<double>& values);
/// Returns whether values change at doubled rows only, as discrete states do.
[[nodiscard]] bool is_discrete(const std::vector<double>& t, const std::vector<double>& values);

/// Returns whether any switching function, or group by `indicator`, slides between a row and the next.
[[nodiscard]] bool slides(const result::Trajectory& trajectory, std::size_t row);

/// Holds rows [begin, end) less than a pixel apart in which a curve jumps to and fro: lines would show something
/// slower. The mean over time is one of whole periods, from a jump upwards to another one.
struct Chattering {
  std::size_t begin = 0, end = 0;
  double from = 0.0, to = 0.0, low = 0.0, high = 0.0, mean = 0.0;
};
/// @param least_jump  differences across an event up to this one are roundings
[[nodiscard]] std::vector<Chattering> chattering_pixels(const std::vector<double>& t, const std::vector<double>& y,
                                                        double pixel, double least_jump);

/// Holds a curve x, y over t cut into lines: `line` gets its pieces, with whether they slide, `jump` both ends of every
/// jump. Rows closer together than `pixel` in t are thinned to the first, the least, the greatest and the last of y;
/// those of `left_out` are not drawn.
struct CurvePieces {
  struct Piece {
    std::vector<Point> points;
    std::vector<double> t;  ///< of the points; two at one time may be a corner
    bool sliding = false;
  };
  std::vector<Piece> lines;
  std::vector<std::vector<Point>> jumps;
};
[[nodiscard]] CurvePieces curve_pieces(const result::Trajectory& trajectory, const std::vector<double>& x,
                                       const std::vector<double>& y, const Plot& plot, double pixel, bool steps,
                                       const std::vector<Chattering>& left_out = {});

/// Draws lines, and dotted the jumps in a colour of their own.
/// @param wide  of lines that slide, in their colour; 0 draws them as all others
void draw_pieces(Svg& svg, const CurvePieces& pieces, const Pen& pen, std::string_view jump_color, double wide);

/// Puts points between those of lines, on cubics in time whose rates are those of parabolas over three points: rows
/// true to each column leave corners in a plane. Lines stay straight where that would be more than a line's width away.
void round_corners(CurvePieces& pieces);

[[nodiscard]] Range time_range(const result::Result& result);
/// Returns the range of them all.
[[nodiscard]] Range time_range(const result::Result& result, const FigureOverlays& overlays);
[[nodiscard]] std::string heading_of(const result::Result& result);
/// Returns the name of the model and what follows it, the name shortened to what the width of the picture has room for.
[[nodiscard]] std::string title_line(const result::Result& result, const std::string& rest);

/// Panels, and bands, of a figure at most: a sheet of paper is no longer. Letters of a line beside them.
inline constexpr std::size_t most_panels = 24, letters_beside = 18;

/// Returns the switching functions that have a band: all if they are few, else those whose mode changes.
[[nodiscard]] std::vector<std::size_t> banded(const result::Result& result);
/// Says what can be seen in bands.
struct DrawnModes {
  bool minus = false, sliding = false, plus = false, chattering = false;
};
/// Draws bands of switching functions: below their middle psi < 0, above it psi > 0, all of them sliding; where they
/// chatter each half is as full as its part of the time, and the middle is hatched.
/// @param drawn  gets what is among them
/// @return where the next thing can stand
double draw_bands(Svg& svg, const result::Result& result, const std::vector<std::size_t>& bands, const Plot& time,
                  double top, DrawnModes& drawn);

/// Draws these columns over time, one below the other; of none those that move, as the page draws them.
[[nodiscard]] std::string draw_over_time(const result::Result& result, const std::vector<FigureColumn>& columns,
                                         const FigureOverlays& overlays);
/// Draws one column over another one, with the surfaces of the plane, its vector field and the events.
[[nodiscard]] std::string draw_in_a_plane(const result::Result& result, const FigureColumn& x, const FigureColumn& y,
                                          const FigureOverlays& overlays);

}  // namespace saltus::report
