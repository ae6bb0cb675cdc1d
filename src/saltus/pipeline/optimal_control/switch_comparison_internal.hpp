// Which switches of two trajectories are the same, interval by interval.
#pragma once

#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Holds one switching function, or one group of regions, that goes from one mode to another.
struct Switch {
  double t = 0.0;
  std::size_t place = 0;  ///< 2 i of switching function i of the result, 2 i + 1 of group i
  std::string from, to;
};

/// Returns the changes of every function and group in the events, by time. Functions that change together are one each,
/// so that rounding, which puts one of them before the other, makes no difference.
/// @param is_listed  one per switching function of the result: changes of others (kinks) are no switches
[[nodiscard]] std::vector<Switch> switches_of(const result::Events& events, const std::vector<bool>& is_listed);

struct SwitchComparison {
  double time_error = 0.0;  ///< largest over those that are the same
  int missed = 0;           ///< simulated, and not in the solution
  int extra = 0;            ///< of the solution, and not simulated
};

/// Compares what was simulated, interval by interval, with the solution. Switches are the same if place and modes are;
/// among the ways to pair those of an interval in their order, as many as possible are paired, then as near as
/// possible. Switches within `end_tolerance` lengths of an end of their interval may belong to either side of it. Of
/// two separate simulations they may happen in both or in neither. If no other one is the same, they do not count.
/// @param times  N + 1 ends of the intervals
/// @param simulated  N lists
/// Cost: for every interval and place the product of the numbers of switches.
[[nodiscard]] SwitchComparison compare_switches(const std::vector<double>& times,
                                                const std::vector<std::vector<Switch>>& simulated,
                                                const std::vector<Switch>& solution, double end_tolerance);

}  // namespace saltus::pipeline
