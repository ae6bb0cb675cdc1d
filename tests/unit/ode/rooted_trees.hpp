// Order conditions of Runge-Kutta methods: sum b_i Phi_i(tree) = 1 / gamma(tree) for every rooted tree up to the order
// (Hairer, Norsett & Wanner, II.2). The trees are generated, not listed.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace saltus::ode::trial {

using Row = std::vector<double>;

struct Tree {
  std::size_t order = 1;
  double gamma = 1.0;
  std::vector<std::size_t> children;  ///< positions in the list of all trees, ascending
};

namespace detail {
inline void add_trees(std::vector<Tree>& trees, std::size_t count, Tree tree, std::size_t missing, std::size_t first) {
  if (missing == 0) {
    tree.gamma *= static_cast<double>(tree.order);
    trees.push_back(tree);
    return;
  }
  for (std::size_t child = first; child < count; ++child) {
    const Tree subtree = trees[child];
    if (subtree.order > missing) break;
    Tree grown = tree;
    grown.gamma *= subtree.gamma;
    grown.children.push_back(child);
    add_trees(trees, count, grown, missing - subtree.order, child);
  }
}
}  // namespace detail

/// All rooted trees with at most `order` vertices, ordered by their number of vertices.
inline std::vector<Tree> rooted_trees(std::size_t order) {
  std::vector<Tree> trees{Tree{}};
  for (std::size_t n = 2; n <= order; ++n) {
    detail::add_trees(trees, trees.size(), Tree{.order = n, .gamma = 1.0, .children = {}}, n - 1, 0);
  }
  return trees;
}

/// Phi_i(tree) for every tree and stage.
inline std::vector<Row> elementary_weights(const std::vector<Tree>& trees, const std::vector<Row>& a) {
  std::vector<Row> phi;
  for (const Tree& tree : trees) {
    Row row(a.size(), 1.0);
    for (const std::size_t child : tree.children) {
      for (std::size_t i = 0; i < a.size(); ++i) {
        double sum = 0.0;
        for (std::size_t j = 0; j < a.size(); ++j) sum += a[i][j] * phi[child][j];
        row[i] *= sum;
      }
    }
    phi.push_back(row);
  }
  return phi;
}

/// The conditions of one method, with the size of the terms in each, which is what its rounding is measured by.
class OrderConditions {
 public:
  OrderConditions(const std::vector<Row>& a, std::size_t order) : trees_(rooted_trees(order)) {
    std::vector<Row> sizes = a;
    for (Row& row : sizes) {
      for (double& value : row) value = std::abs(value);
    }
    phi_ = elementary_weights(trees_, a);
    phi_size_ = elementary_weights(trees_, sizes);
  }

  /// Largest defect of the conditions with `order` vertices for weights b at theta, in roundings of the terms' sizes
  /// and in absolute terms.
  struct Defect {
    double in_roundings = 0.0;
    double absolute = 0.0;
  };
  [[nodiscard]] Defect defect(const Row& b, std::size_t order, double theta) const {
    Defect largest;
    for (std::size_t k = 0; k < trees_.size(); ++k) {
      if (trees_[k].order != order) continue;
      const double exact = std::pow(theta, static_cast<double>(order)) / trees_[k].gamma;
      double sum = 0.0;
      double size = exact;
      for (std::size_t i = 0; i < b.size(); ++i) {
        sum += b[i] * phi_[k][i];
        size += std::abs(b[i]) * phi_size_[k][i];
      }
      const double defect = std::abs(sum - exact);
      largest.absolute = std::max(largest.absolute, defect);
      largest.in_roundings = std::max(largest.in_roundings, defect / size / std::numeric_limits<double>::epsilon());
    }
    return largest;
  }

 private:
  std::vector<Tree> trees_;
  std::vector<Row> phi_;
  std::vector<Row> phi_size_;
};

}  // namespace saltus::ode::trial
