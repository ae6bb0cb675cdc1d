// How many smooth branches nested nonsmooth terms unfold into.
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include <casadi/core/sx_elem.hpp>

// Needs names that only the header above brings.
#include <casadi/core/calculus.hpp>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// The walk over the decisions; values that are known under the decisions so far are numbers, all others NaN.
class BranchCounter {
 public:
  BranchCounter(const Tape& tape, int root, int limit)
      : tape_(tape), root_(root), limit_(limit), cone_(tape.cone(std::span(&root, 1), Links::through_alpha)) {}

  [[nodiscard]] int count() {
    descend();
    return found_;
  }

 private:
  double known(int node) const {
    const auto it = known_.find(node);
    return it == known_.end() ? unknown : it->second;
  }

  double known_operation(const TapeNode& node) const {
    const double left = known(node.left);
    const double right = node.right < 0 ? 0.0 : known(node.right);
    const bool product = node.operation == casadi::OP_MUL;
    if ((product || node.operation == casadi::OP_IF_ELSE_ZERO) && left == 0.0) return 0.0;
    if (product && right == 0.0) return 0.0;
    if (std::isnan(left) || std::isnan(right)) return unknown;
    return tape_.operate(node, left, right);
  }

  void propagate() {
    for (const int current : cone_) {
      const TapeNode& node = tape_[current];
      double value = unknown;
      if (node.psi >= 0) {
        const auto decided = decided_.find(current);
        value = decided != decided_.end() ? decided->second : step_value(known(node.psi));
      } else if (node.variable >= 0 && node.operation != cell_operation) {
        const Variable& variable = tape_.variables()[at(node.variable)];
        if (variable.kind == VariableKind::parameter) value = variable.value;
      } else {
        value = node.left < 0 ? node.constant : known_operation(node);
      }
      known_[current] = value;
    }
  }

  /// The undecided alpha with the smallest number that still matters, -1 if there is none. Its own psi contains no
  /// undecided alpha, as those would have smaller numbers.
  int next() const {
    int smallest = -1;
    std::vector<int> open{root_};
    std::unordered_map<int, bool> seen;
    while (!open.empty()) {
      const int current = open.back();
      open.pop_back();
      if (current < 0 || !std::isnan(known(current)) || !seen.emplace(current, true).second) continue;
      const TapeNode& node = tape_[current];
      if (node.psi >= 0 && (smallest < 0 || current < smallest)) smallest = current;
      open.insert(open.end(), {node.left, node.right, node.psi});
    }
    return smallest;
  }

  void descend() {
    if (found_ > limit_) return;
    propagate();
    const int alpha = next();
    if (alpha < 0) {
      ++found_;
      return;
    }
    for (const double side : {1.0, 0.0}) {
      decided_[alpha] = side;
      descend();
    }
    decided_.erase(alpha);
  }

  const Tape& tape_;
  int root_;
  int limit_;
  std::vector<int> cone_;
  std::map<int, double> decided_;
  std::unordered_map<int, double> known_;
  int found_ = 0;
};

}  // namespace

int count_branches(const Tape& tape, int node, int limit) { return BranchCounter(tape, node, limit).count(); }

}  // namespace saltus::model
