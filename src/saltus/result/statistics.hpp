// What a computation cost.
#pragma once

#include <cstdint>
#include <optional>

namespace saltus::result {

struct Statistics {
  std::int64_t steps = 0;
  std::int64_t rejected = 0;
  std::int64_t rhs_evaluations = 0;
  double wall_seconds = 0.0;
  /// Of `output = "auto"` with very many rows: from here on some of them, not those at events, were left out.
  std::optional<double> thinned_from{};
  /// Of finite elements with switch detection: the estimated errors of all elements added up, relative to the largest
  /// value that the state has; of the state where that is worst.
  std::optional<double> error_estimate{};
};

}  // namespace saltus::result
