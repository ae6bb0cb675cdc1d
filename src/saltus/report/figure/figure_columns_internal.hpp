// Columns of a trajectory as a figure draws them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "saltus/report/figure/svg_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

enum class ColumnSort { state, output, control, alpha, time };

struct FigureColumn {
  std::string name;
  ColumnSort sort = ColumnSort::state;
  std::size_t index = 0;
  std::vector<double> values;
};

/// All columns of the trajectory and the time behind them; rows that are too short count as not a number.
[[nodiscard]] std::vector<FigureColumn> figure_columns(const result::Result& result);

/// Least and greatest finite value; {0, 0} if there is none.
[[nodiscard]] Range range_of(const std::vector<double>& values);
/// A range with a little room; one that is a point gets room of its own size.
[[nodiscard]] Range roomy(Range range);
/// Whether values change by more than rounding.
[[nodiscard]] bool moves(const std::vector<double>& values);
/// Whether values change at doubled rows only, as discrete states do.
[[nodiscard]] bool is_discrete(const std::vector<double>& t, const std::vector<double>& values);

/// Whether any switching function, or group by `indicator`, slides between a row and the next.
[[nodiscard]] bool slides(const result::Trajectory& trajectory, std::size_t row);

/// A curve x, y over t cut into lines: `line` gets its pieces, with whether they slide, `jump` both ends of every jump.
/// Rows closer together than `pixel` in t are thinned to the first, the least, the greatest and the last of y.
struct CurvePieces {
  struct Piece {
    std::vector<Point> points;
    bool sliding = false;
  };
  std::vector<Piece> lines;
  std::vector<std::vector<Point>> jumps;
};
[[nodiscard]] CurvePieces curve_pieces(const result::Trajectory& trajectory, const std::vector<double>& x,
                                       const std::vector<double>& y, const Plot& plot, double pixel, bool steps);

}  // namespace saltus::report
