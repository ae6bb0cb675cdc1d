// How coarse a run is: the estimated errors of its elements.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/fesd_integrator/element.hpp"

namespace saltus::fesd_integrator {

/// Adds up the errors of all elements (Defect), by component, and compares them with the largest value that the
/// component has had by the end: an estimate of the error of a solution that neither damps nor amplifies errors.
class Coarseness {
 public:
  void note(const Element& element, const std::vector<double>& errors);
  struct Worst {
    std::size_t state = 0;  ///< where the sum is largest
    double sum = 0.0;       ///< both relative
    double error = 0.0;     ///< of the worst element
    double t = 0.0;         ///< where that begins
  };
  /// nullopt before the first element, and where all states are 0.
  [[nodiscard]] std::optional<Worst> worst() const;

 private:
  std::vector<double> largest_, sum_, error_, t_;
};

}  // namespace saltus::fesd_integrator
