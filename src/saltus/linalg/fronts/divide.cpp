#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/linalg/block_order.hpp"
#include "saltus/linalg/fronts/block_tree_internal.hpp"
#include "saltus/linalg/fronts/merge_internal.hpp"
#include "saltus/linalg/fronts/pairs_internal.hpp"

namespace saltus::linalg {
namespace {

using fronts::Block;
using fronts::BlockTree;

/// Sets of the nodes of one front, as bits: own ones first, then each row of the boundary.
class NodeSets {
 public:
  void reset(int nodes) {
    words_ = (nodes + word_bits - 1) / word_bits;
    bits_.assign(at(nodes) * at(words_), 0);
  }
  void add(int set, int node) { word(set, node) |= bit(node); }
  void remove(int set, int node) { word(set, node) &= ~bit(node); }
  [[nodiscard]] bool has(int set, int node) { return (word(set, node) & bit(node)) != 0; }
  void add_all(int set, int other) {
    for (int w = 0; w < words_; ++w) bits_[at(set * words_ + w)] |= bits_[at(other * words_ + w)];
  }
  [[nodiscard]] int count(int set) const {
    int all = 0;
    for (int w = 0; w < words_; ++w) all += std::popcount(bits_[at(set * words_ + w)]);
    return all;
  }

 private:
  static constexpr int word_bits = 64;
  static std::uint64_t bit(int node) { return std::uint64_t{1} << at(node % word_bits); }
  std::uint64_t& word(int set, int node) { return bits_[at(set * words_ + node / word_bits)]; }

  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// Orders the nodes of one block after the other.
class Division {
 public:
  Division(const BlockTree& tree, const std::vector<int>& node_of_row)
      : tree_(tree), node_of_row_(node_of_row), local_(node_of_row.size(), -1) {}

  /// Returns the place of the node of each row in the order of elimination.
  std::vector<int> run() {
    place_.assign(at(tree_.size), 0);
    for (const Block& block : tree_.blocks) {
      find_neighbours(block);
      eliminate(block);
    }
    return std::move(place_);
  }

 private:
  void find_neighbours(const Block& block) {
    own_ = 0;
    node_at_.clear();
    for (int k = 0; k < block.rows; ++k) {
      int& local = local_[at(node_of_row_[at(tree_.rows[at(block.first_row + k)])])];
      if (local < 0) local = own_++;
      node_at_.push_back(local);
    }
    for (int k = 0; k < block.boundary; ++k) node_at_.push_back(own_ + k);
    neighbours_.reset(own_ + block.boundary);
    for (int e = block.first_entry; e < block.first_entry + block.entries; ++e) {
      join(node_at_[at(tree_.row_place[at(e)])], node_at_[at(tree_.column_place[at(e)])]);
    }
    for (int c = 0; c < block.children; ++c) {
      const Block& child = tree_.blocks[at(tree_.child[at(block.first_child + c)])];
      const auto places = std::span(tree_.in_parent).subspan(at(child.first_boundary), at(child.boundary));
      for (const int i : places) {
        for (const int j : places) join(node_at_[at(i)], node_at_[at(j)]);
      }
    }
  }

  void join(int i, int j) {
    if (i == j) return;
    neighbours_.add(i, j);
    neighbours_.add(j, i);
  }

  void eliminate(const Block& block) {
    std::vector<int> degree(at(own_)), step(at(own_), -1);
    for (int i = 0; i < own_; ++i) degree[at(i)] = neighbours_.count(i);
    for (int k = 0; k < own_; ++k) {
      int least = -1;
      for (int i = 0; i < own_; ++i) {
        if (step[at(i)] < 0 && (least < 0 || degree[at(i)] < degree[at(least)])) least = i;
      }
      step[at(least)] = next_++;
      for (int i = 0; i < own_; ++i) {
        if (step[at(i)] >= 0 || !neighbours_.has(least, i)) continue;
        neighbours_.add_all(i, least);
        neighbours_.remove(i, i);
        neighbours_.remove(i, least);
        degree[at(i)] = neighbours_.count(i);
      }
    }
    for (int k = 0; k < block.rows; ++k) {
      place_[at(tree_.rows[at(block.first_row + k)])] = step[at(node_at_[at(k)])];
    }
  }

  const BlockTree& tree_;
  const std::vector<int>& node_of_row_;
  std::vector<int> local_;    ///< of each node, in its block
  std::vector<int> node_at_;  ///< of each place in the front
  NodeSets neighbours_;
  int own_ = 0, next_ = 0;
  std::vector<int> place_;
};

}  // namespace

std::vector<int> divide_blocks(Index equations, std::span<const int> rows, std::span<const int> columns,
                               std::span<const int> block) {
  const auto size = static_cast<int>(block.size());
  if (size == 0) return {};
  const auto equation = fronts::pair_equations(size, static_cast<int>(equations), rows, columns, block);
  // An equation whose variable is eliminated later would have no pivot before.
  std::vector<int> later(block.begin(), block.end());
  for (std::size_t v = 0; v < equation.size(); ++v) {
    if (equation[v] < 0) continue;
    const auto row = equation.size() + at(equation[v]);
    if (later[row] < later[v]) later[row] = later[v];
    if (later[v] < later[row]) later[v] = later[row];
  }
  const auto node = fronts::nodes_of_pairs(equation, size);
  const auto place = Division(fronts::make_block_tree(size, rows, columns, later), node).run();
  return fronts::merge_blocks(fronts::make_block_tree(size, rows, columns, place));
}

}  // namespace saltus::linalg
