#include "saltus/switching/plane/plane_table.hpp"

#include "saltus/base/contracts.hpp"

namespace saltus::switching {

PlaneTable plane_table(const std::array<std::array<double, 4>, 2>& velocities) {
  PlaneTable table;
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const double velocity = velocities[j][corner];
      const Drift drift = velocity > 0.0 ? Drift::up : velocity < 0.0 ? Drift::down : Drift::stays;
      table.sides[j][corner] = {velocity, drift};
    }
  }
  return table;
}

PlaneTable plane_table(const CornerTable& table) {
  SALTUS_ASSERT(table.surfaces == 2);
  PlaneTable plane;
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      plane.sides[j][corner] = table.side(static_cast<int>(j), corner);
    }
  }
  return plane;
}

}  // namespace saltus::switching
