#include "saltus/linalg/block_order.hpp"

#include <algorithm>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/fronts/block_tree_internal.hpp"
#include "saltus/linalg/fronts/merge_internal.hpp"
#include "saltus/linalg/fronts/pairs_internal.hpp"
#include "saltus/linalg/sparse_factors.hpp"

namespace saltus::linalg {
namespace {

/// The places of nodes in an order of least degree.
std::vector<int> places_by_degree(const std::vector<int>& node, std::span<const int> rows,
                                  std::span<const int> columns) {
  const int nodes = *std::max_element(node.begin(), node.end()) + 1;
  std::vector<std::pair<int, int>> edges;
  // AMD takes rows without a diagonal entry for dense ones.
  for (int i = 0; i < nodes; ++i) edges.emplace_back(i, i);
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const int i = node[at(rows[e])], j = node[at(columns[e])];
    edges.emplace_back(i, j);
    edges.emplace_back(j, i);
  }
  const fronts::Graph graph(nodes, std::move(edges));
  const auto order = order_of_least_degree(nodes, graph.start, graph.neighbour);
  std::vector<int> place(at(nodes));
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
  return place;
}

}  // namespace

std::vector<int> blocks_by_minimum_degree(Index size, Index equations, std::span<const int> rows,
                                          std::span<const int> columns) {
  if (size == 0) return {};
  const auto n = static_cast<int>(size);
  auto block = fronts::nodes_of_pairs(fronts::pair_equations(n, static_cast<int>(equations), rows, columns), n);
  const auto place = places_by_degree(block, rows, columns);
  for (int& b : block) b = place[at(b)];
  return fronts::merge_blocks(fronts::make_block_tree(n, rows, columns, block));
}

}  // namespace saltus::linalg
