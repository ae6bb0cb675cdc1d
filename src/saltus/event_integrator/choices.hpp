// Decisions where the solution is not unique: which there are in a run, and which of their alternatives to follow.
#pragma once

#include <cstddef>

namespace saltus::event_integrator {

/// One of the alternatives of a decision, both by their numbers: decisions with alternatives are counted along a run.
struct Choice {
  long decision = 0;
  std::size_t alternative = 0;
};

/// An event with alternatives, and the number of the decision that it shows.
struct BranchPoint {
  std::size_t event = 0;
  long decision = 0;
};

}  // namespace saltus::event_integrator
