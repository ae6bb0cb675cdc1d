// The tree of trajectories through decisions where the solution is not unique.
#pragma once

#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/choices.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// From the root to a branch: what was chosen on the way.
using Path = std::vector<event_integrator::Choice>;

/// Holds one trajectory, and where others leave it.
struct Followed {
  result::Result result;
  std::vector<event_integrator::BranchPoint> branch_points;
  std::vector<long> family_numbers;  ///< in the run, of result.families
  bool reached = true;               ///< false: stopped before the last choice of its path
};

/// Says which trajectory this is, from 1, of how many that are known and will be followed.
struct Count {
  long number = 1;
  long known = 1;
};

struct Follow {
  long trajectories = 1;  ///< at most, >= 1
  long members = 0;       ///< of every family, evenly spread over its times or phases, ends not among them
};

/// Follows the alternatives of all events breadth first, so that what is found first is followed first: the
/// trajectory without choices, then its branches in the order of events and alternatives, behind them those of
/// families, then theirs.
/// @param run  computes the trajectory of a path; one that ends with stopped_by_user is the last
[[nodiscard]] result::Result follow_branches(FunctionRef<Followed(const Path&, const Count&)> run,
                                             const Follow& follow);

}  // namespace saltus::pipeline
