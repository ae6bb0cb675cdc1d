// Which block meets which, and where entries stand in the fronts: all of a factorisation that depends on no value.
#pragma once

#include <span>
#include <vector>

namespace saltus::linalg::fronts {

/// Holds one block of rows. Places in its front: its own rows, then its boundary; delayed rows come between both.
struct Block {
  int first_row = 0, rows = 0;           ///< own rows, in BlockTree::rows
  int first_boundary = 0, boundary = 0;  ///< rows of later blocks that meet it, in BlockTree::boundary
  int first_entry = 0, entries = 0;      ///< of the matrix, in BlockTree::row_place and column_place
  int first_child = 0, children = 0;     ///< in BlockTree::child
  int parent = -1;

  [[nodiscard]] int size() const { return rows + boundary; }
};

/// Holds the blocks in a postorder: each follows its children at once. So what these leave to it lies on top of a
/// stack.
struct BlockTree {
  int size = 0;
  std::vector<Block> blocks;
  std::vector<int> rows;       ///< of the matrix, block by block
  std::vector<int> boundary;   ///< of the matrix, block by block; by increasing place in the order of elimination
  std::vector<int> in_parent;  ///< as boundary: the place in the front of the parent, without delayed rows
  std::vector<int> child;
  std::vector<int> entry_of;                 ///< for each value of the matrix
  std::vector<int> row, column;              ///< of each entry, as the matrix numbers them
  std::vector<int> row_place, column_place;  ///< in the front of its block; the column is one of its own rows

  [[nodiscard]] int entries() const { return static_cast<int>(row.size()); }
};

/// As BlockLdl::analyse. Cost: the entries and the boundaries, each by its logarithm.
[[nodiscard]] BlockTree make_block_tree(int size, std::span<const int> rows, std::span<const int> columns,
                                        std::span<const int> block);

}  // namespace saltus::linalg::fronts
