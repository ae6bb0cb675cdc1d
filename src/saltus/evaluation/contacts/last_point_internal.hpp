// Where something was last evaluated.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace saltus::evaluation {

/// Of t, x, p, alpha; null ones are zeros, as in functions: before a start selections are not known.
using PointArguments = std::array<std::span<const double>, 4>;

class LastPoint {
 public:
  /// Returns whether it is this point, bit by bit, and takes it if it is not.
  [[nodiscard]] bool is_at(const PointArguments& point);
  [[nodiscard]] std::array<const double*, 4> pointers() const {
    return {arguments_[0].data(), arguments_[1].data(), arguments_[2].data(), arguments_[3].data()};
  }
  /// Returns its p, of which what follows from the point may be set.
  [[nodiscard]] std::vector<double>& parameters() { return arguments_[2]; }

 private:
  std::array<std::vector<double>, 4> arguments_;  ///< empty before the first point
};

}  // namespace saltus::evaluation
