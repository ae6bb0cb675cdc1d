// What campaigns of random systems count.
#pragma once

#include <string>
#include <vector>

namespace saltus::robustness {

/// What came out of the systems of one family.
struct Tally {
  long systems = 0;
  long completed = 0;      ///< by all integrators
  long outside_class = 0;  ///< by at least one of them
  long not_unique = 0;     ///< completed, but with an event that Filippov's theory leaves open: not compared
  long sensitive = 0;      ///< completed, but neighbours part: not compared
  long events = 0;
  long jumps = 0, accumulations = 0;  ///< of these
  long held_by_three = 0;             ///< rows with three and more active regions
  std::vector<std::string> failures;  ///< "family seed integrator: what is wrong"

  Tally& operator+=(const Tally& other) {
    systems += other.systems;
    completed += other.completed;
    outside_class += other.outside_class;
    not_unique += other.not_unique;
    sensitive += other.sensitive;
    events += other.events;
    jumps += other.jumps;
    accumulations += other.accumulations;
    held_by_three += other.held_by_three;
    failures.insert(failures.end(), other.failures.begin(), other.failures.end());
    return *this;
  }
};

}  // namespace saltus::robustness
