// The places of a pattern's entries as linear algebra takes them.
#pragma once

#include <vector>

#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::ode {

/// Holds what JacobianPattern does, in the numbers of linalg's sparse factors.
struct PatternPlaces {
  std::vector<int> start, row;

  explicit PatternPlaces(const JacobianPattern& pattern)
      : start(pattern.start.begin(), pattern.start.end()), row(pattern.row.begin(), pattern.row.end()) {}
};

}  // namespace saltus::ode
