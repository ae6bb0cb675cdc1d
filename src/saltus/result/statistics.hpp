// What a computation cost.
#pragma once

#include <cstdint>

namespace saltus::result {

struct Statistics {
  std::int64_t steps = 0;
  std::int64_t rejected = 0;
  std::int64_t rhs_evaluations = 0;
  double wall_seconds = 0.0;
};

}  // namespace saltus::result
