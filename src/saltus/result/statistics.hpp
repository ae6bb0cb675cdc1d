// What a computation cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace saltus::result {

/// Says how many steps a method has taken, and how much time has passed in them.
struct IntegratorUse {
  std::string name;
  std::int64_t steps = 0;
  double time = 0.0;
};

struct Statistics {
  std::int64_t steps = 0;
  std::int64_t rejected = 0;
  std::int64_t rhs_evaluations = 0;
  double wall_seconds = 0.0;
  /// Of `integrator = "auto"`: by which methods the steps were taken.
  std::vector<IntegratorUse> integrators{};
  /// Of `output = "auto"` with very many rows: from here on some of them, not those at events, were left out.
  std::optional<double> thinned_from{};
  /// Of finite elements with switch detection: the estimated errors of all elements added up, relative to the largest
  /// value that the state has; of the state where that is worst.
  std::optional<double> error_estimate{};
};

}  // namespace saltus::result
