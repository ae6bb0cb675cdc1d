// The values that expressions have on a surface and beside it, on either side: what a jump is told from a kink by.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "saltus/model/graph/tape_internal.hpp"

namespace saltus::model {

/// Holds one switching function, by node numbers.
struct Surface {
  int psi = 0;
  int alpha = 0;
};

/// Three values of a target: for alpha_j = 0, 1/2 and 1.
using Triple = std::array<double, 3>;
using Difference = double (*)(const Triple&);

[[nodiscard]] inline double jump_of(const Triple& values) { return values[2] - values[0]; }
[[nodiscard]] inline double bend_of(const Triple& values) { return values[1] - 0.5 * (values[0] + values[2]); }

/// Which values the selections of the other surfaces have.
enum class OtherSelections {
  signs,    ///< those of their switching functions at the point
  between,  ///< numbers between 0 and 1: a difference that is 0 for these is 0 for all of them
};

/// Evaluates targets at a point on a surface and a step away from it.
class SurfaceProfile {
 public:
  /// @param with_cells  values may be constant beside the surface (tables)
  SurfaceProfile(const Tape& tape, const Surface& surface, std::span<const int> targets, bool with_cells,
                 OtherSelections others = OtherSelections::signs);

  /// Gives the selections of the other surfaces their values at a point.
  void hold_others(Point& point);
  /// @param scale  sizes of the coordinates of psi, 0 for the others
  void at(Point point, const std::vector<double>& scale);

  /// Returns whether a difference of a target's three values is more than what remains of a difference that vanishes on
  /// the surface itself: rounding, and the part of its value nearby that belongs to the |psi| the point is left with
  /// (its square root, as for sqrt(abs(psi))). Differences that are not finite do not count.
  [[nodiscard]] std::optional<bool> exceeds(std::size_t target, Difference difference) const;

 private:
  enum class Rounding { bounded, ignored };

  [[nodiscard]] double triples(Point& point, const std::vector<double>& scale, std::vector<Triple>& triples,
                               Rounding rounding);

  const Tape& tape_;
  Surface surface_;
  std::vector<int> targets_, cone_;
  bool cells_ = false;
  OtherSelections others_;
  TapeValues values_;
  std::vector<Triple> here_, nearby_;
  std::vector<double> bound_;
  double psi_here_ = 0.0, psi_nearby_ = 0.0;
};

}  // namespace saltus::model
