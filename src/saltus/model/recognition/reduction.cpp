#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <unordered_map>

#include "saltus/model/recognition/recognition_internal.hpp"
#include "saltus/model/recognition/reduction_internal.hpp"

namespace saltus::model {
namespace {

using Alphas = std::vector<int>;  // ascending

Alphas joined(const Alphas& a, const Alphas& b) {
  Alphas result;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

Alphas common(const Alphas& a, const Alphas& b) {
  Alphas result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

/// Alphas a node has in it. The guard of a blend only repeats the zero of its weight.
Alphas alphas_of(const Tape& tape, int root) {
  Alphas found;
  std::vector<int> open{root};
  std::set<int> met;
  while (!open.empty()) {
    const int current = open.back();
    open.pop_back();
    if (current < 0 || (tape[current].written & kind_bit(VariableKind::alpha)) == 0) continue;
    if (!met.insert(current).second) continue;
    const TapeNode& node = tape[current];
    if (node.psi >= 0) found.push_back(current);
    if (node.operation != casadi::OP_IF_ELSE_ZERO) open.push_back(node.left);
    open.push_back(node.right);
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Alphas in which nodes are not affine, of every node asked for and of those below. Only products and quotients ask
/// which alphas their operands have: a sum costs what its terms do.
class NonaffineTable {
 public:
  const Alphas& of(const Tape& tape, int node) {
    if (!has_alphas(tape, node)) return none_;
    if (const auto it = known_.find(node); it != known_.end()) return it->second;
    for (const int current : tape.cone(std::span(&node, 1), Links::written)) {
      if (has_alphas(tape, current) && !known_.contains(current)) known_.emplace(current, nonaffine(tape, current));
    }
    return known_[node];
  }

 private:
  static bool has_alphas(const Tape& tape, int node) {
    return node >= 0 && (tape[node].written & kind_bit(VariableKind::alpha)) != 0;
  }

  [[nodiscard]] Alphas nonaffine(const Tape& tape, int number) const {
    const TapeNode& node = tape[number];
    if (node.psi >= 0) return {};
    const auto of_operand = [&](int operand) { return has_alphas(tape, operand) ? known_.at(operand) : Alphas(); };
    const bool both = has_alphas(tape, node.left) && has_alphas(tape, node.right);
    switch (node.operation) {
      case casadi::OP_ADD:
      case casadi::OP_SUB:
      case casadi::OP_NEG:
      case casadi::OP_TWICE:
        return joined(of_operand(node.left), of_operand(node.right));
      case casadi::OP_IF_ELSE_ZERO:
        return of_operand(node.right);
      case casadi::OP_MUL: {
        auto result = joined(of_operand(node.left), of_operand(node.right));
        return both ? joined(result, common(alphas_of(tape, node.left), alphas_of(tape, node.right))) : result;
      }
      case casadi::OP_DIV:
        return joined(of_operand(node.left), alphas_of(tape, node.right));
      default:
        return alphas_of(tape, number);
    }
  }

  Alphas none_;
  std::unordered_map<int, Alphas> known_;
};

class Interpolation {
 public:
  Interpolation(SxGraph& graph, const std::set<int>& alphas) : graph_(graph), alphas_(alphas) {}

  /// Nothing if the corners of one term exceed the limit.
  std::optional<SXElem> of_sum(int root) {
    if (!first_nonaffine(root)) return graph_.expression(root);
    const TapeNode node = graph_.tape()[root];
    const bool is_sum = node.operation == casadi::OP_ADD || node.operation == casadi::OP_SUB;
    if (is_sum || node.operation == casadi::OP_NEG) {
      const auto left = of_sum(node.left);
      const auto right = is_sum ? of_sum(node.right) : SXElem(0.0);
      if (!left || !right) return std::nullopt;
      return is_sum ? SXElem::binary(node.operation, *left, *right) : -*left;
    }
    corners_ = 0;
    return of_term(root);
  }

 private:
  std::optional<int> first_nonaffine(int node) {
    for (const int alpha : nonaffine_.of(graph_.tape(), node)) {
      if (alphas_.contains(alpha)) return alpha;
    }
    return std::nullopt;
  }

  std::optional<SXElem> of_term(int root) {
    const auto alpha = first_nonaffine(root);
    if (!alpha) {
      ++corners_;
      return graph_.expression(root);
    }
    if (corners_ >= branch_limit) return std::nullopt;
    const auto above = of_term(graph_.node(graph_.with_alphas(root, {{*alpha, 1.0}})));
    const auto below = of_term(graph_.node(graph_.with_alphas(root, {{*alpha, 0.0}})));
    if (!above || !below || corners_ > branch_limit) return std::nullopt;
    return graph_.blend(graph_.expression(*alpha), *above, *below);
  }

  SxGraph& graph_;
  const std::set<int>& alphas_;
  NonaffineTable nonaffine_;
  int corners_ = 0;
};

}  // namespace

std::vector<int> nonaffine_alphas(const Tape& tape, int node) { return NonaffineTable().of(tape, node); }

Expected<SXElem> interpolate(SxGraph& graph, int node, const std::set<int>& alphas, const std::string& what) {
  auto result = Interpolation(graph, alphas).of_sum(node);
  if (!result) return tl::unexpected(chain_too_long(what));
  return *result;
}

}  // namespace saltus::model
