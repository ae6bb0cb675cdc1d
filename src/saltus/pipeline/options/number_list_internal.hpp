// Vectors of the solver as lists of a result.
#pragma once

#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::pipeline {

[[nodiscard]] inline std::vector<double> list_of(linalg::ConstView vector) {
  std::vector<double> list(static_cast<std::size_t>(vector.size()));
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = vector[static_cast<linalg::Index>(i)];
  return list;
}

}  // namespace saltus::pipeline
