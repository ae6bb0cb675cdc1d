#include <algorithm>
#include <set>

#include "saltus/base/at.hpp"
#include "saltus/model/recognition/jump_paths_internal.hpp"
#include "saltus/model/recognition/surface_points_internal.hpp"

namespace saltus::model {
namespace {

/// Starts of the search for points: usual sizes, and tiny ones (start_point).
constexpr int usual_starts = 8, first_tiny = 48, end_of_tiny = 56;
constexpr int enough_values = 4;

/// Whether the two values of a node are equal at points on the surface, the other selections between 0 and 1.
bool is_continuous(const Tape& whole, const Surface& surface, int node, std::size_t& nodes) {
  const int roots[] = {node, surface.psi, surface.alpha};
  const Tape tape = whole.part(roots);
  nodes += at(tape.size());
  for (int i = 0; i < tape.size(); ++i) {
    if (tape[i].operation == cell_operation) return false;
  }
  const int target = tape.place_of(node);
  const Surface here{tape.place_of(surface.psi), tape.place_of(surface.alpha)};
  Projection projection(tape, here.psi);
  SurfaceProfile profile(tape, here, std::span(&target, 1), false, OtherSelections::between);
  const std::vector<int> both{target, here.psi};
  const auto variables = moving_variables(tape, both);
  int values = 0;
  for (int k = 0; k < end_of_tiny; k = k + 1 == usual_starts ? first_tiny : k + 1) {
    std::vector<double> scale;
    Point point = start_point(tape, variables, k);
    profile.hold_others(point);  // psi may hold some: with others the point is not on the surface
    if (!projection.onto(0.0, point, scale)) continue;
    profile.at(point, scale);
    const auto jumps = profile.exceeds(0, jump_of);
    if (jumps.value_or(false)) return false;
    values += jumps ? 1 : 0;
  }
  return values >= enough_values;
}

}  // namespace

Users::Users(const Tape& tape, std::span<const int> targets)
    : is_target_(at(tape.size()), false), start_(at(tape.size()) + 1, 0) {
  for (const int target : targets) is_target_[at(target)] = true;
  const auto cone = tape.cone(targets, Links::through_alpha);
  const auto each = [&](auto take) {
    for (const int node : cone) {
      for (const int operand : {tape[node].left, tape[node].right}) {
        if (operand >= 0) take(operand, node);
      }
    }
  };
  each([&](int operand, int) { ++start_[at(operand) + 1]; });
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  users_.resize(at(start_.back()));
  std::vector<int> next(start_.begin(), start_.end() - 1);
  each([&](int operand, int node) { users_[at(next[at(operand)]++)] = node; });
}

std::span<const int> Users::of(int node) const {
  const auto first = at(start_[at(node)]);
  return std::span(users_).subspan(first, at(start_[at(node) + 1]) - first);
}

bool ends_nearby(const Tape& tape, const Surface& surface, const Users& users, std::size_t most_nodes) {
  if (users.is_target(surface.alpha)) return false;
  const auto first = users.of(surface.alpha);
  std::set<int> open(first.begin(), first.end());
  std::size_t nodes = 0;
  // Operands have smaller numbers: what is taken has all its jumping operands behind it.
  while (!open.empty()) {
    const int node = *open.begin();
    open.erase(open.begin());
    if (is_continuous(tape, surface, node, nodes)) continue;
    if (users.is_target(node) || nodes > most_nodes) return false;
    const auto further = users.of(node);
    open.insert(further.begin(), further.end());
  }
  return true;
}

}  // namespace saltus::model
