// Pictures of bodies: what [mechanics] says is drawn, at the rows of a trajectory.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace saltus::result {

/// Holds a line through points of the plane, or a disc around one.
struct DrawnShape {
  bool is_disc = false;
  std::size_t points = 1;  ///< of a disc 1

  /// Returns numbers that say where it is: x and y of every point, then the radius of a disc.
  [[nodiscard]] std::size_t numbers() const { return 2 * points + (is_disc ? 1 : 0); }
  bool operator==(const DrawnShape&) const = default;
};

/// Holds the bodies of a mechanical system along a trajectory.
struct Drawing {
  std::vector<DrawnShape> shapes;
  std::vector<std::vector<double>> rows;  ///< by row of the trajectory: the numbers of all shapes, one after the other

  /// Returns numbers of a row.
  [[nodiscard]] std::size_t width() const {
    std::size_t sum = 0;
    for (const auto& shape : shapes) sum += shape.numbers();
    return sum;
  }
};

}  // namespace saltus::result
