#include "saltus/mpcc/elimination.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"

namespace saltus::mpcc {
namespace {

int last_block(const std::vector<int>& blocks) {
  return blocks.empty() ? 0 : std::max(0, *std::max_element(blocks.begin(), blocks.end()));
}

}  // namespace

std::vector<int> elimination_blocks(const Chain& chain, int variables) {
  std::vector<int> blocks(at(variables), -1);
  const auto put = [&](const IndexRange& range, int block) {
    std::fill(blocks.begin() + range.first, blocks.begin() + range.end(), block);
  };
  const int elements = static_cast<int>(chain.elements.size());
  for (int e = 0; e < elements; ++e) put(chain.elements[at(e)].variables, elements - 1 - e);
  for (const auto& interval : chain.intervals) put(interval.shared, elements - 1 - interval.first_element);
  put(chain.start, elements);
  put(chain.border, elements + 1);
  return blocks;
}

std::vector<int> blocks_of_rows(const std::vector<int>& of_variables, const Pattern& jacobian, int rows) {
  const int last = last_block(of_variables);
  std::vector<int> blocks(at(rows), last);
  for (int entry = 0; entry < jacobian.entries(); ++entry) {
    const int row = jacobian.row[at(entry)], block = of_variables[at(jacobian.column[at(entry)])];
    if (row < rows && block >= 0) blocks[at(row)] = std::min(blocks[at(row)], block);
  }
  return blocks;
}

void place_with_rows(std::vector<int>& of_variables, const Pattern& jacobian, int rows) {
  const auto of_rows = blocks_of_rows(of_variables, jacobian, rows);
  const int last = last_block(of_variables);
  auto placed = of_variables;
  for (int entry = 0; entry < jacobian.entries(); ++entry) {
    const int row = jacobian.row[at(entry)];
    const auto column = at(jacobian.column[at(entry)]);
    if (row < rows && of_variables[column] < 0) placed[column] = std::max(placed[column], of_rows[at(row)]);
  }
  for (int& block : placed) block = block < 0 ? last : block;
  of_variables = std::move(placed);
}

}  // namespace saltus::mpcc
