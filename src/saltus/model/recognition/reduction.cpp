#include <algorithm>
#include <iterator>
#include <optional>
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

/// Alphas a node depends on, and those among them in which it is not affine.
struct Degrees {
  Alphas all, nonaffine;
};

Degrees degrees_of(const TapeNode& node, int number, const std::unordered_map<int, Degrees>& known) {
  if (node.psi >= 0) return {{number}, {}};
  if (node.left < 0) return {};
  const Degrees none;
  const Degrees& a = known.at(node.left);
  const Degrees& b = node.right < 0 ? none : known.at(node.right);
  Degrees result{joined(a.all, b.all), joined(a.nonaffine, b.nonaffine)};
  switch (node.operation) {
    case casadi::OP_ADD:
    case casadi::OP_SUB:
    case casadi::OP_NEG:
    case casadi::OP_TWICE:
      break;
    case casadi::OP_IF_ELSE_ZERO:
      return b;  // the guard of a blend only repeats the zero of its weight
    case casadi::OP_MUL:
      result.nonaffine = joined(result.nonaffine, common(a.all, b.all));
      break;
    case casadi::OP_DIV:
      result.nonaffine = joined(a.nonaffine, b.all);
      break;
    default:
      result.nonaffine = result.all;
  }
  return result;
}

/// Degrees of every node asked for and of those below, each computed once.
class DegreeTable {
 public:
  const Degrees& of(const Tape& tape, int node) {
    if (const auto it = known_.find(node); it != known_.end()) return it->second;
    for (const int current : tape.cone(std::span(&node, 1), Links::written)) {
      if (!known_.contains(current)) known_.emplace(current, degrees_of(tape[current], current, known_));
    }
    return known_.at(node);
  }

 private:
  std::unordered_map<int, Degrees> known_;
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
    for (const int alpha : degrees_.of(graph_.tape(), node).nonaffine) {
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
  DegreeTable degrees_;
  int corners_ = 0;
};

}  // namespace

std::vector<int> nonaffine_alphas(const Tape& tape, int node) {
  if ((tape[node].written & kind_bit(VariableKind::alpha)) == 0) return {};
  return DegreeTable().of(tape, node).nonaffine;
}

Expected<SXElem> interpolate(SxGraph& graph, int node, const std::set<int>& alphas, const std::string& name) {
  auto result = Interpolation(graph, alphas).of_sum(node);
  if (!result) return tl::unexpected(chain_too_long("the dynamics of " + name));
  return *result;
}

}  // namespace saltus::model
