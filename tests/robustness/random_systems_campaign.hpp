// Many random systems, each simulated with every explicit integrator and checked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "random_systems.hpp"

namespace saltus::robustness {

/// What came out of the systems of one family.
struct Tally {
  long systems = 0;
  long completed = 0;      ///< by all integrators
  long outside_class = 0;  ///< by at least one of them
  long not_unique = 0;     ///< completed, but with an event that Filippov's theory leaves open: not compared
  long sensitive = 0;      ///< completed, but neighbours part: not compared
  long events = 0;
  std::vector<std::string> failures;  ///< "family seed integrator: what is wrong"
};

/// Systems first, first + 1, … of a family.
[[nodiscard]] Tally run_campaign(Family family, std::uint64_t first, std::uint64_t count);

}  // namespace saltus::robustness
