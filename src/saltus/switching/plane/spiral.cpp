#include "saltus/switching/plane/spiral.hpp"

#include <cmath>

namespace saltus::switching {
namespace {

constexpr std::array<std::size_t, 4> counterclockwise_order{0, 1, 3, 2};  // (--), (+-), (++), (-+)

/// Side of surface j on which a corner lies.
int sign_of(std::size_t corner, std::size_t surface) { return (corner >> surface & 1U) != 0 ? 1 : -1; }

/// Whether every region is left through the surface that the next one in `order` lies behind, and entered from the
/// last one.
bool turns(const PlaneTable& table, const std::array<std::size_t, 4>& order) {
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t corner = order[i];
    const std::size_t crossed = (corner ^ order[(i + 1) % 4]) >> 1U;  // 1 -> 0, 2 -> 1
    if (static_cast<int>(table.side(crossed, corner).drift) != -sign_of(corner, crossed)) return false;
    if (static_cast<int>(table.side(1 - crossed, corner).drift) != sign_of(corner, 1 - crossed)) return false;
  }
  return true;
}

}  // namespace

std::optional<Turning> turning(const PlaneTable& table) {
  const auto& order = counterclockwise_order;
  if (turns(table, order)) return Turning::counterclockwise;
  if (turns(table, {order[0], order[3], order[2], order[1]})) return Turning::clockwise;
  return std::nullopt;
}

std::optional<SpiralCycle> spiral_cycle(const PlaneTable& table, std::size_t first) {
  const auto sense = turning(table);
  if (!sense) return std::nullopt;
  std::size_t at = 0;
  while (counterclockwise_order[at] != first) ++at;
  const std::size_t step = *sense == Turning::counterclockwise ? 1 : 3;
  SpiralCycle cycle;
  double distance = 1.0;
  for (std::size_t i = 0; i < 4; ++i, at = (at + step) % 4) {
    const std::size_t corner = counterclockwise_order[at];
    const std::size_t crossed = (corner ^ counterclockwise_order[(at + step) % 4]) >> 1U;
    cycle.corners[i] = corner;
    cycle.durations[i] = distance / std::abs(table.velocity(crossed, corner));
    distance = cycle.durations[i] * std::abs(table.velocity(1 - crossed, corner));
  }
  cycle.cycle_ratio = distance;
  return cycle;
}

}  // namespace saltus::switching
