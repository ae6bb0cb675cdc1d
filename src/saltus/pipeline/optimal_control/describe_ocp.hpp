// What `saltus check` says of an optimal control problem: its size, and what may go wrong.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

/// Holds numbers of a problem or a part of it.
struct OcpCounts {
  long variables = 0;
  long equations = 0;  ///< rows of constraints, equations and inequalities
  long pairs = 0;      ///< complementarities
  long nonzeros = 0;   ///< of the Jacobian of constraints and both sides of the pairs
};

struct OcpOverview {
  std::vector<OcpCounts> intervals;  ///< of each: what belongs to it alone
  OcpCounts problem;                 ///< all together, with what intervals share
  std::vector<std::string> warnings;
};

/// Transcribes the problem as pipeline::optimize does, and counts. Warns of an initial state on a surface (the
/// complementarity there is biactive from the start), of guesses that were moved onto their bounds, and of costs that
/// nothing influences.
/// Fails as pipeline::optimize does before it solves anything.
[[nodiscard]] Expected<OcpOverview> describe_ocp(const model::Ocp& ocp, const OptimizeOptions& options);

}  // namespace saltus::pipeline
