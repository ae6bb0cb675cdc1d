// How coarse a run is: the estimated errors of its elements.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {

/// Adds up the errors of all elements (Defect), by component, and compares them with the largest value that the
/// component has had by the end: an estimate of the error of a solution that neither damps nor amplifies errors.
class Coarseness {
 public:
  /// Sets the `limit` of that sum over a run of length `span`; nullopt if elements may be as coarse as they are.
  Coarseness(std::optional<double> limit, double span) : limit_(limit), span_(span) {}

  /// Returns the error of an element that might be next over its share of the limit, limit h / span times the largest
  /// value so far: with shares up to 1 the sum stays below the limit. 0 without a limit.
  [[nodiscard]] double share(const Element& element, const std::vector<double>& errors) const;
  void note(const Element& element, const std::vector<double>& errors);
  struct Worst {
    std::size_t state = 0;  ///< where the sum is largest
    double sum = 0.0;       ///< both relative
    double error = 0.0;     ///< of the worst element
    double t = 0.0;         ///< where that begins
  };
  /// Returns the worst; nullopt before the first element, and where all states are 0.
  [[nodiscard]] std::optional<Worst> worst() const;

 private:
  std::optional<double> limit_;
  double span_ = 0.0;
  std::vector<double> largest_, sum_, error_, t_;
};

}  // namespace saltus::fesd_integrator
