#include <algorithm>
#include <numeric>

#include "saltus/linalg/fronts/pairs_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

/// Gives equations variables of their own, as many as can have one.
class Matching {
 public:
  Matching(const Graph& variables_of, int equations, int variables)
      : variables_of_(variables_of), next_(at(equations)), seen_(at(variables), -1), equation_(at(variables), -1) {}

  /// The equation of each variable, or -1.
  std::vector<int> run() {
    std::vector<int> order(next_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [this](int i, int j) { return variables_of_.of(i).size() < variables_of_.of(j).size(); });
    for (const int equation : order) find(equation);
    return std::move(equation_);
  }

 private:
  /// Looks for a chain of equations, each of which gives its variable to the one before, the last for a free one.
  void find(int root) {
    std::vector<int> chain{root}, taken;
    next_[at(root)] = 0;
    while (!chain.empty()) {
      const int equation = chain.back();
      const auto variables = variables_of_.of(equation);
      const auto free =
          std::find_if(variables.begin(), variables.end(), [this](int v) { return equation_[at(v)] < 0; });
      if (free != variables.end()) {
        taken.push_back(*free);
        for (std::size_t k = 0; k < chain.size(); ++k) equation_[at(taken[k])] = chain[k];
        return;
      }
      auto& next = next_[at(equation)];
      while (next < variables.size() && seen_[at(variables[next])] == root) ++next;
      if (next == variables.size()) {
        chain.pop_back();
        if (!taken.empty()) taken.pop_back();
        continue;
      }
      const int variable = variables[next];
      seen_[at(variable)] = root;
      taken.push_back(variable);
      chain.push_back(equation_[at(variable)]);
      next_[at(chain.back())] = 0;
    }
  }

  const Graph& variables_of_;
  std::vector<std::size_t> next_;  ///< of each equation in the chain: the variable to look at
  std::vector<int> seen_;          ///< the last root whose search met a variable
  std::vector<int> equation_;
};

}  // namespace

Graph::Graph(int size, std::vector<std::pair<int, int>> edges) : start(at(size) + 1, 0) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [from, to] : edges) {
    ++start[at(from) + 1];
    neighbour.push_back(to);
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
}

std::vector<int> pair_equations(int size, int equations, std::span<const int> rows, std::span<const int> columns) {
  const int variables = size - equations;
  std::vector<std::pair<int, int>> entries;
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const auto [low, high] = std::minmax(rows[e], columns[e]);
    if (low < variables && high >= variables) entries.emplace_back(high - variables, low);
  }
  const auto equation = Matching(Graph(equations, std::move(entries)), equations, variables).run();
  std::vector<int> node(at(size), -1);
  int nodes = 0;
  for (int v = 0; v < variables; ++v) {
    node[at(v)] = nodes++;
    if (equation[at(v)] >= 0) node[at(variables + equation[at(v)])] = node[at(v)];
  }
  for (int& n : node) n = n < 0 ? nodes++ : n;
  return node;
}

}  // namespace saltus::linalg::fronts
