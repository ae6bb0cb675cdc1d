// How sigma and the barrier parameter fall in one loop: sigma leads, mu follows.
#pragma once

#include <optional>

#include "saltus/solver/homotopy/follow_path.hpp"

namespace saltus::solver::homotopy {

/// Holds the parameter of a relaxed problem, and that of its barrier.
struct Level {
  double sigma = 1.0;
  double mu = 0.1;
};

/// Returns what is solved behind this level, none behind the last one of the schedule: sigma falls by its factor, and
/// mu stays 100 times smaller. With mu equal to sigma control problems end in bad optima, with a mu that is much
/// smaller iterations double. At the last sigma mu falls alone.
[[nodiscard]] std::optional<Level> next_level(const Schedule& schedule, const Level& solved);

/// Returns to which error the first problem of a loop is solved: a tenth of the barrier parameter that belongs to its
/// sigma, and 1e-3 for any sigma > 1. Digits behind are lost at the next sigma, and cost the most where an optimum of
/// large sigma is flat; with errors that are ten times larger some control
/// problems end in bad optima.
[[nodiscard]] double first_tolerance(double sigma);

}  // namespace saltus::solver::homotopy
