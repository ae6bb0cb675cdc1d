// Sliding surfaces that influence each other, and regions among them whose gradients depend on each other.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/event_integrator/field/large_group.hpp"
#include "saltus/event_integrator/mode/region_ties.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/switching/plane/bilinear_root.hpp"
#include "saltus/switching/regions/region_weights.hpp"
#include "saltus/switching/selections/selection_newton.hpp"

namespace saltus::event_integrator {

/// Holds rows of the sliding surfaces in groups, how each group is solved, and work space for that.
struct SlidingGroups {
  explicit SlidingGroups(std::size_t surfaces) : row_of(surfaces, -1) {}

  std::vector<std::vector<std::size_t>> lists;    ///< rows that influence each other, connected and ascending
  std::vector<std::size_t> alone;                 ///< the other rows, ascending
  std::vector<std::array<std::size_t, 2>> pairs;  ///< those of two, where they are evaluated together
  std::vector<switching::PairCorners> corners;    ///< of these, at one point
  std::vector<std::size_t> size;                  ///< by row, 0 behind the first of a group
  /// By row, for the first of a pair: known once it was evaluated.
  std::vector<std::optional<switching::RootKind>> kind;
  std::vector<std::optional<switching::SelectionNewton>> newton;  ///< by row, for the first of a larger group
  std::optional<LargeGroup> large;
  std::vector<double> selections;  ///< of the current group
  std::vector<double> speed;       ///< by row: in groups of more than two
  std::vector<double> scaled;      ///< G of such a group, rows over their speeds
  std::vector<double> condition;   ///< by row: of a coupled selection
  std::vector<int> row_of;         ///< by surface while groups are found, -1 = it is not slid on
  std::vector<bool> placed;        ///< by row while groups are found

  struct Moved {
    std::size_t state, row;
  };
  std::vector<Moved> moved;    ///< states whose rows of f hold a selection, if all are alone and none has several
  std::vector<bool> is_moved;  ///< by state while these are found
};

/// Holds regions of a group by `indicator` that slide, as rows, and the reference they are measured against.
struct SlidingRegions {
  int reference = 0;
  std::vector<std::size_t> rows;
  /// Where the gradients of `rows` depend on each other.
  std::optional<switching::RegionWeights> tie = {};
  RegionBasis basis = {};
  linalg::Matrix gradients = {};  ///< that the tie was made of
  bool constant = false;          ///< gradients of all rows
};

struct SlidingTies {
  std::vector<SlidingRegions> regions;
  bool known = false;  ///< of this mode: once gradients are
  linalg::Matrix rows, rates;
  std::vector<double> theta;
};

}  // namespace saltus::event_integrator
