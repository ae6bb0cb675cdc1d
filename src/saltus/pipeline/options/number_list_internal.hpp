// Vectors of the solver as lists of a result.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace saltus::pipeline {

[[nodiscard]] inline std::vector<double> list_of(const Eigen::VectorXd& vector) {
  return {vector.data(), vector.data() + vector.size()};
}

}  // namespace saltus::pipeline
