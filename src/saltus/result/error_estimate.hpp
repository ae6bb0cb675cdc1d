// How far a simulation is from the solution.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace saltus::result {

/// Holds estimates of global errors, by a second run whose tolerances, steps or smoothing are `ratio` times as large.
struct ErrorEstimate {
  double ratio = 0.01;
  std::vector<std::vector<double>> x;  ///< of every row and state, |x - x of the second run|
  std::vector<double> event_times;     ///< of the events that both runs have, in their order
  std::vector<double> final;           ///< of every state at the end
  /// The first event that the runs do not share, number from 0: from there on they have different modes.
  std::optional<std::size_t> parted_at;
};

}  // namespace saltus::result
