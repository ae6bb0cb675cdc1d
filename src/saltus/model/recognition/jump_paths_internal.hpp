// How far the jump of a selection goes up the expressions it is in, step by step.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/graph/tape_internal.hpp"
#include "saltus/model/recognition/surface_profile_internal.hpp"

namespace saltus::model {

/// Holds for each node of the expressions of some targets the operations that it is an operand of.
class Users {
 public:
  Users(const Tape& tape, std::span<const int> targets);
  [[nodiscard]] std::span<const int> of(int node) const;
  [[nodiscard]] bool is_target(int node) const { return is_target_[at(node)]; }

 private:
  std::vector<bool> is_target_;
  std::vector<int> start_, users_;
};

/// Returns whether operations near a selection make the two values of its surface equal, whatever the other selections
/// are, so that no target jumps: max(x, 0) = alpha x does at its first operation. False where that takes more than
/// `most_nodes` evaluated nodes to see, where a target jumps, or a table is met.
[[nodiscard]] bool ends_nearby(const Tape& tape, const Surface& surface, const Users& users, std::size_t most_nodes);

}  // namespace saltus::model
