#include "saltus/base/at.hpp"
#include "saltus/linalg/fronts/merge_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

/// What a front costs, in multiplications: those of its pivots, and the work on its entries and the calls around it.
double cost_of_front(int pivots, int size) {
  constexpr double per_entry = 4.0, per_front = 1000.0;
  double cost = per_front + per_entry * size * size;
  for (int k = 0; k < pivots; ++k) cost += 0.5 * (size - k) * (size - k);
  return cost;
}

}  // namespace

std::vector<int> merge_blocks(const BlockTree& tree) {
  constexpr int most_rows = 64;
  const auto blocks = tree.blocks.size();
  std::vector<int> into(blocks), rows(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    into[b] = static_cast<int>(b);
    rows[b] = tree.blocks[b].rows;
  }
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto& block = tree.blocks[b];
    if (block.parent < 0) continue;
    const auto parent = at(block.parent);
    const int outside = tree.blocks[parent].boundary;
    const int both = rows[b] + rows[parent];
    const double apart =
        cost_of_front(rows[b], rows[b] + block.boundary) + cost_of_front(rows[parent], rows[parent] + outside);
    if (both > most_rows || cost_of_front(both, both + outside) > apart) continue;
    rows[parent] = both;
    into[b] = block.parent;
  }
  // A parent has a larger number than its children.
  for (std::size_t b = blocks; b-- > 0;) into[b] = into[at(into[b])];
  std::vector<int> result(at(tree.size));
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto& block = tree.blocks[b];
    for (int k = 0; k < block.rows; ++k) result[at(tree.rows[at(block.first_row + k)])] = into[b];
  }
  return result;
}

}  // namespace saltus::linalg::fronts
