// Piecewise functions of one argument by their cells: breaks, and in every cell a few constants.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace saltus::model {

/// Names interpolation between the points of a table.
enum class TableKind {
  linear,  ///< straight between points: kinks at all of them
  cubic,   ///< not-a-knot cubic spline: twice differentiable inside, kinks at the two ends
};

/// Holds the real line cut at its breaks; a break belongs to the cell above it (right-continuous). Within a cell a
/// function of the argument is a smooth expression of the cell's constants and the argument.
struct CellTable {
  enum class Breaks {
    integers,  ///< cell k is [k, k + 1) and its only constant is k
    listed,    ///< cell k is [breaks[k - 1], breaks[k]), unbounded below the first and above the last
  };
  /// Says what happens at a break.
  enum class Change {
    jump,  ///< the function jumps: signs of switching functions are read anew
    kink,  ///< it is continuous, some derivative is not
  };

  Breaks kind = Breaks::integers;
  Change change = Change::jump;
  std::vector<double> breaks;     ///< ascending, for `listed`
  std::vector<double> constants;  ///< (breaks + 1) rows of `columns`, for `listed`
  int columns = 1;

  /// Returns whether the function is a spline: it has a slope at its inner breaks.
  [[nodiscard]] bool has_slope() const { return kind == Breaks::listed && columns == 5; }
  /// Returns the cell an argument lies in; 0 for NaN.
  [[nodiscard]] long cell(double argument) const;
  /// Returns the ends of a cell; infinite where it is unbounded.
  [[nodiscard]] double lower(long cell) const;
  [[nodiscard]] double upper(long cell) const;
  [[nodiscard]] double constant(long cell, int column) const;
};

/// Returns cells of floor: the constant is the largest integer not above the argument.
[[nodiscard]] CellTable integer_cells();

/// Returns cells of a table: with constants (x_k, y_k, b_k) of a linear one the value is y_k + b_k d, d = argument -
/// x_k; with (x_k, y_k, b_k, c_k, d_k) of a cubic one it is y_k + d (b_k + d (c_k + d d_k)). Constant outside [x_0,
/// x_n]. The points must have passed find_mistake. Cost: linear in the number of points.
[[nodiscard]] CellTable table_cells(const std::vector<double>& x, const std::vector<double>& y, TableKind kind);

/// Returns cells of a piecewise constant function: value k from time k on, the first one before; equal neighbours are
/// one cell.
[[nodiscard]] CellTable step_cells(const std::vector<double>& t, const std::vector<double>& values);

/// Holds points that cannot be a table.
struct PointMistake {
  std::string message, remedy;
  std::optional<std::size_t> point{};  ///< the one that is wrong
  bool in_values = false;              ///< its value, not its argument
};

/// Largest number of points of a table or of samples of an input.
inline constexpr std::size_t most_points = 1'000'000;

/// Checks for different lengths, too few points (2 linear, 4 cubic), too many, not finite, arguments that do not
/// ascend.
[[nodiscard]] std::optional<PointMistake> find_mistake(const std::vector<double>& x, const std::vector<double>& y,
                                                       TableKind kind);
/// Does the same for samples of an input, of which one is enough.
[[nodiscard]] std::optional<PointMistake> find_mistake(const std::vector<double>& t, const std::vector<double>& values);

}  // namespace saltus::model
