// The first relaxed problems of many starts.
#pragma once

#include <vector>

#include "saltus/solver/relaxed_path_internal.hpp"

namespace saltus::solver {

/// Says where the path of a start has come to.
struct Explored {
  PathEnd end = PathEnd::failed;
  PathProgress progress;
};

/// Follows the path of each start in a run of its own, in SolveOptions::threads threads, down to sigma = `until`. What
/// they have done is recorded in `run`, in the order of the starts; iterations of starts with a name are outside of its
/// limit, which the others share.
[[nodiscard]] std::vector<Explored> explore(Run& run, const std::vector<Attempt>& starts, double until);

}  // namespace saltus::solver
