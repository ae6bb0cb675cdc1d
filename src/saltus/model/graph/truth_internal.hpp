// Truth values of conditions as a reduced ordered decision diagram over literals: the compact form of a truth table.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "saltus/base/at.hpp"

namespace saltus::model {

/// A diagram node: the two terminals are 0 (false) and 1 (true).
using Truth = int;

/// Keeps nodes unique, so two conditions with the same truth table are the same number. The multi-affine polynomial of
/// a table is read off the diagram: P(node) = alpha P(high) + (1 - alpha) P(low). A conjunction of m independent
/// literals has m nodes, not 2^m entries.
class TruthDiagram {
 public:
  struct Node {
    int literal = -1;
    Truth low = 0, high = 0;
  };

  [[nodiscard]] static constexpr Truth constant_false() { return 0; }
  [[nodiscard]] static constexpr Truth constant_true() { return 1; }

  Truth literal(int index);
  Truth negation(Truth a);
  Truth conjunction(Truth a, Truth b);
  Truth disjunction(Truth a, Truth b);
  /// Returns `a` where the condition holds, else `b`.
  Truth choice(Truth condition, Truth a, Truth b);
  /// Returns the table of a function of the literals: entry i has bit k of i as the value of literals[k]; literals
  /// ascending.
  Truth table(std::span<const int> literals, const std::vector<bool>& entries);

  [[nodiscard]] const Node& operator[](Truth node) const { return nodes_[at(node)]; }
  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  /// Returns whether there are more nodes than any condition a person writes: further operations give `false`, and the
  /// caller reports it.
  [[nodiscard]] bool overflowed() const { return size() >= node_limit; }

 private:
  static constexpr int node_limit = 200000;
  Truth make(int literal, Truth low, Truth high);

  std::vector<Node> nodes_{{}, {}};
  std::map<std::tuple<int, Truth, Truth>, Truth> unique_;
  std::map<std::pair<Truth, Truth>, Truth> conjunctions_;
};

}  // namespace saltus::model
