#include <algorithm>
#include <numeric>
#include <tuple>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/linalg/fronts/block_tree_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

/// Numbers without gaps, in the same order.
std::vector<int> without_gaps(std::span<const int> block) {
  std::vector<int> used(block.begin(), block.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<int> dense;
  for (const int b : block) {
    dense.push_back(static_cast<int>(std::lower_bound(used.begin(), used.end(), b) - used.begin()));
  }
  return dense;
}

class TreeMaker {
 public:
  TreeMaker(int size, std::span<const int> rows, std::span<const int> columns, std::span<const int> block)
      : rows_(rows), columns_(columns), block_(without_gaps(block)) {
    SALTUS_ASSERT(rows.size() == columns.size() && std::ssize(block) == size);
    tree_.size = size;
    blocks_ = block_.empty() ? 0 : *std::max_element(block_.begin(), block_.end()) + 1;
  }

  BlockTree run() {
    find_boundaries();
    renumber_blocks(postorder());
    place_rows();
    place_entries();
    return std::move(tree_);
  }

 private:
  /// The rows of later blocks that each block meets when it is eliminated: those of its entries, and those that its
  /// children leave to it. The parent is the first of these blocks.
  void find_boundaries() {
    boundary_.resize(at(blocks_));
    for (std::size_t e = 0; e < rows_.size(); ++e) {
      const int i = rows_[e], j = columns_[e];
      const int a = block_[at(i)], b = block_[at(j)];
      if (a != b) boundary_[at(std::min(a, b))].push_back(a < b ? j : i);
    }
    parent_.assign(at(blocks_), -1);
    for (int b = 0; b < blocks_; ++b) {
      auto& own = boundary_[at(b)];
      std::sort(own.begin(), own.end(),
                [this](int i, int j) { return std::pair(block_[at(i)], i) < std::pair(block_[at(j)], j); });
      own.erase(std::unique(own.begin(), own.end()), own.end());
      if (own.empty()) continue;
      const int parent = parent_[at(b)] = block_[at(own.front())];
      for (const int row : own) {
        if (block_[at(row)] != parent) boundary_[at(parent)].push_back(row);
      }
    }
  }

  [[nodiscard]] std::vector<int> postorder() const {
    std::vector<std::vector<int>> children(at(blocks_));
    std::vector<int> order, open;
    for (int b = 0; b < blocks_; ++b) {
      if (parent_[at(b)] >= 0) children[at(parent_[at(b)])].push_back(b);
    }
    // From the last root, parents before children and later children first: the reverse is a postorder.
    for (int b = 0; b < blocks_; ++b) {
      if (parent_[at(b)] < 0) open.push_back(b);
    }
    while (!open.empty()) {
      const int b = open.back();
      open.pop_back();
      order.push_back(b);
      open.insert(open.end(), children[at(b)].begin(), children[at(b)].end());
    }
    std::reverse(order.begin(), order.end());
    return order;
  }

  void renumber_blocks(const std::vector<int>& order) {
    std::vector<int> number(at(blocks_));
    for (int b = 0; b < blocks_; ++b) number[at(order[at(b)])] = b;
    for (int& b : block_) b = number[at(b)];
    tree_.blocks.resize(at(blocks_));
    std::vector<std::vector<int>> children(at(blocks_)), boundary(at(blocks_));
    for (int b = 0; b < blocks_; ++b) {
      const int old = order[at(b)];
      boundary[at(b)] = std::move(boundary_[at(old)]);
      if (parent_[at(old)] < 0) continue;
      tree_.blocks[at(b)].parent = number[at(parent_[at(old)])];
      children[at(tree_.blocks[at(b)].parent)].push_back(b);
    }
    for (int b = 0; b < blocks_; ++b) {
      tree_.blocks[at(b)].first_child = static_cast<int>(tree_.child.size());
      tree_.blocks[at(b)].children = static_cast<int>(children[at(b)].size());
      tree_.child.insert(tree_.child.end(), children[at(b)].begin(), children[at(b)].end());
    }
    boundary_ = std::move(boundary);
  }

  void place_rows() {
    tree_.rows.resize(at(tree_.size));
    std::iota(tree_.rows.begin(), tree_.rows.end(), 0);
    std::stable_sort(tree_.rows.begin(), tree_.rows.end(),
                     [this](int i, int j) { return block_[at(i)] < block_[at(j)]; });
    place_.resize(at(tree_.size));
    for (int p = 0; p < tree_.size; ++p) {
      const int row = tree_.rows[at(p)];
      Block& block = tree_.blocks[at(block_[at(row)])];
      if (block.rows++ == 0) block.first_row = p;
      place_[at(row)] = p;
    }
    for (std::size_t b = 0; b < tree_.blocks.size(); ++b) {
      auto& own = boundary_[b];
      std::sort(own.begin(), own.end(), [this](int i, int j) { return place_[at(i)] < place_[at(j)]; });
      tree_.blocks[b].first_boundary = static_cast<int>(tree_.boundary.size());
      tree_.blocks[b].boundary = static_cast<int>(own.size());
      tree_.boundary.insert(tree_.boundary.end(), own.begin(), own.end());
    }
    for (const Block& block : tree_.blocks) {
      for (int i = 0; i < block.boundary; ++i) {
        tree_.in_parent.push_back(place_in(block.parent, tree_.boundary[at(block.first_boundary + i)]));
      }
    }
  }

  /// The place of a row in the front of a block that owns or meets it.
  [[nodiscard]] int place_in(int block, int row) const {
    const Block& of = tree_.blocks[at(block)];
    if (block_[at(row)] == block) return place_[at(row)] - of.first_row;
    const auto first = tree_.boundary.begin() + of.first_boundary;
    const auto found = std::lower_bound(first, first + of.boundary, row,
                                        [this](int i, int j) { return place_[at(i)] < place_[at(j)]; });
    SALTUS_ASSERT(*found == row);
    return of.rows + static_cast<int>(found - first);
  }

  /// Numbers the places of entries by block, column and row of its front.
  void place_entries() {
    struct Place {
      int row, value;
    };
    // First by column, in the order of elimination.
    std::vector<int> start(at(tree_.size) + 1, 0);
    for (std::size_t e = 0; e < rows_.size(); ++e) {
      ++start[at(std::min(place_[at(rows_[e])], place_[at(columns_[e])])) + 1];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Place> places(rows_.size());
    auto next = start;
    for (std::size_t e = 0; e < rows_.size(); ++e) {
      const auto [column, row] = std::minmax(place_[at(rows_[e])], place_[at(columns_[e])]);
      places[at(next[at(column)]++)] = {row, static_cast<int>(e)};
    }
    tree_.entry_of.resize(rows_.size());
    for (int column = 0; column < tree_.size; ++column) {
      const auto first = places.begin() + start[at(column)], last = places.begin() + start[at(column) + 1];
      std::sort(first, last,
                [](const Place& a, const Place& b) { return std::tie(a.row, a.value) < std::tie(b.row, b.value); });
      const int block = block_[at(tree_.rows[at(column)])];
      int before = -1;
      for (auto place = first; place != last; ++place) {
        if (place->row != before) {
          before = place->row;
          add_entry(block, column - tree_.blocks[at(block)].first_row, place_in(block, tree_.rows[at(before)]));
        }
        tree_.entry_of[at(place->value)] = tree_.entries() - 1;
      }
    }
  }

  void add_entry(int b, int column, int row) {
    Block& block = tree_.blocks[at(b)];
    if (block.entries++ == 0) block.first_entry = tree_.entries();
    tree_.column_place.push_back(column);
    tree_.row_place.push_back(row);
    tree_.column.push_back(tree_.rows[at(block.first_row + column)]);
    tree_.row.push_back(row < block.rows ? tree_.rows[at(block.first_row + row)]
                                         : tree_.boundary[at(block.first_boundary + row - block.rows)]);
  }

  std::span<const int> rows_, columns_;
  std::vector<int> block_;  ///< of each row
  int blocks_ = 0;
  std::vector<std::vector<int>> boundary_;
  std::vector<int> parent_;
  std::vector<int> place_;  ///< of each row in the order of elimination
  BlockTree tree_;
};

}  // namespace

BlockTree make_block_tree(int size, std::span<const int> rows, std::span<const int> columns,
                          std::span<const int> block) {
  return TreeMaker(size, rows, columns, block).run();
}

}  // namespace saltus::linalg::fronts
