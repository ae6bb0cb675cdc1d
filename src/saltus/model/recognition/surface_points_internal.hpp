// Finding points on surfaces psi = 0 of a tape, and points on the wanted sides of others.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/tape_internal.hpp"

namespace saltus::model {

/// Returns an entry of a list with one for each node, or for each variable.
[[nodiscard]] inline double entry(const std::vector<double>& values, int index) { return values[saltus::at(index)]; }

/// Returns the variables t, x, u below the roots, also through alphas.
[[nodiscard]] std::vector<int> moving_variables(const Tape& tape, std::span<const int> roots);

/// Returns the alphas (nodes) below the roots, ascending.
[[nodiscard]] std::vector<int> alpha_nodes(const Tape& tape, std::span<const int> roots, Links links);

/// Returns the start number k with the given variables set: every second one around the initial state, the others
/// around 0; sizes from 1e-3 to 1e3, some down to 1e-30.
[[nodiscard]] Point start_point(const Tape& tape, std::span<const int> variables, int k);

/// Moves points onto psi = level by Newton's method along the gradient; coordinates move in proportion to their size.
class Projection {
 public:
  Projection(const Tape& tape, int psi);

  /// @return whether |psi - level| fell to rounding level; `scale` gets the sizes of the coordinates the point went
  ///         through (0 for those psi does not depend on).
  bool onto(double level, Point& point, std::vector<double>& scale);

  /// Holds psi at a point, and the size of its terms there.
  struct Value {
    double psi, size;
  };
  [[nodiscard]] Value at(const Point& point);

 private:
  void note_sizes(const Point& point, std::vector<double>& scale) const;
  bool step(double level, Point& point, std::vector<double>& scale);

  const Tape& tape_;
  int psi_;
  std::vector<int> cone_;
  std::vector<int> variables_;
  TapeValues values_;
};

/// Selections by alpha node: wanted sides of surfaces (1 or 0), or the values where psi is 0.
using Selections = std::map<int, double>;

/// Moves a point to the wanted sides of some surfaces by projecting onto them in turns, with a margin that shrinks from
/// turn to turn. Discrete functions come to 0 itself if that is their wanted side (of n == 2 nothing else is), and have
/// their wanted sides in the point found; those of cells, which nothing moves, have them wherever the point is.
/// @param held      the surface the point must stay on
/// @param discrete  the discrete functions, and the side that their zero is on
/// @return whether a point was found
[[nodiscard]] bool move_to_sides(const Tape& tape, Projection& held, const Selections& sides,
                                 const Selections& discrete, Point& point, std::vector<double>& scale);

}  // namespace saltus::model
