#include <algorithm>
#include <numeric>

#include "saltus/linalg/fronts/pairs_internal.hpp"

namespace saltus::linalg::fronts {
namespace {

/// Gives equations variables of their own, as many as can have one.
class Matching {
 public:
  /// @param equation  of each variable, or -1; they are kept, perhaps with other variables
  Matching(const Graph& variables_of, int equations, std::vector<int> equation)
      : variables_of_(variables_of), next_(at(equations)), seen_(equation.size(), -1), equation_(std::move(equation)) {}

  /// The equation of each variable, or -1.
  std::vector<int> run() {
    std::vector<int> order;
    std::vector<bool> has_one(next_.size(), false);
    for (const int equation : equation_) {
      if (equation >= 0) has_one[at(equation)] = true;
    }
    for (int equation = 0; equation < std::ssize(next_); ++equation) {
      if (!has_one[at(equation)]) order.push_back(equation);
    }
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

std::vector<int> pair_equations(int size, int equations, std::span<const int> rows, std::span<const int> columns,
                                std::span<const int> block) {
  const int variables = size - equations;
  std::vector<std::pair<int, int>> all, inside;
  for (std::size_t e = 0; e < rows.size(); ++e) {
    const auto [low, high] = std::minmax(rows[e], columns[e]);
    if (low >= variables || high < variables) continue;
    all.emplace_back(high - variables, low);
    if (!block.empty() && block[at(low)] == block[at(high)]) inside.push_back(all.back());
  }
  std::vector<int> equation(at(variables), -1);
  equation = Matching(Graph(equations, std::move(inside)), equations, std::move(equation)).run();
  return Matching(Graph(equations, std::move(all)), equations, std::move(equation)).run();
}

std::vector<int> nodes_of_pairs(const std::vector<int>& equation, int size) {
  const int variables = static_cast<int>(equation.size());
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
