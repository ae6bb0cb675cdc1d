// Connected components of a graph whose edges become known one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace saltus {

/// Holds disjoint sets of 0, 1, ..., n - 1 under union by the smallest member, with paths halved: m operations cost
/// O((m + n) log n).
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  /// Returns the smallest member of the component of k.
  [[nodiscard]] std::size_t first(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(std::size_t a, std::size_t b) {
    a = first(a);
    b = first(b);
    if (b < a) std::swap(a, b);
    parent_[b] = a;
  }
  /// Returns all components, by their smallest members; members ascend.
  [[nodiscard]] std::vector<std::vector<std::size_t>> lists() {
    std::vector<std::vector<std::size_t>> found;
    std::vector<std::size_t> place(parent_.size());
    for (std::size_t k = 0; k < parent_.size(); ++k) {
      const std::size_t root = first(k);
      if (root == k) {
        place[k] = found.size();
        found.emplace_back();
      }
      found[place[root]].push_back(k);
    }
    return found;
  }
  /// Returns all components as the members with these numbers: members[k] for k.
  [[nodiscard]] std::vector<std::vector<int>> lists_of(const std::vector<int>& members) {
    std::vector<std::vector<int>> found;
    for (const auto& list : lists()) {
      auto& component = found.emplace_back();
      for (const std::size_t k : list) component.push_back(members[k]);
    }
    return found;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Returns the components of members of which joins(a, b) says whether two are joined, by their first members; each
/// ascends.
template <class Joins>
[[nodiscard]] std::vector<std::vector<int>> components_of(const std::vector<int>& members, Joins joins) {
  Components components(members.size());
  for (std::size_t b = 0; b < members.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (components.first(a) != components.first(b) && joins(members[a], members[b])) components.join(a, b);
    }
  }
  auto found = components.lists_of(members);
  for (auto& component : found) std::sort(component.begin(), component.end());
  return found;
}

}  // namespace saltus
