#include "saltus/evaluation/guard_words.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

/// The state that a jump turns from 0 to 1 and back, and that has its name; -1 without one.
int turned_state(const model::System& system, const model::Jump& jump) {
  if (jump.targets.size() != 1) return -1;
  const int state = jump.targets.front();
  const bool is_turn = SX::is_equal(jump.values(0), 1.0 - system.x(state), 2);
  return is_turn && system.state_names[at(state)] == jump.name ? state : -1;
}

/// The condition of a jump where its state has a value: guards of that state alone are decided.
SX condition_at(const model::System& system, const model::Jump& jump, int state, double value) {
  SX selections = jump.guard_alpha;
  for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
    const SX guard = SX::substitute(SX(jump.guards(i)), system.x(state), SX(value));
    if (!guard.is_constant()) continue;
    const auto number = static_cast<double>(guard.scalar());
    selections(i) = number > 0.0 || (number == 0.0 && jump.true_at_equality[at(i)]) ? 1.0 : 0.0;
  }
  const SX condition = SX::substitute(jump.value, system.x(state), SX(value));
  return SX::substitute(condition, jump.guard_alpha, selections);
}

}  // namespace

std::vector<std::string> guard_words(const model::System& system, const model::Jump& jump) {
  std::vector<std::string> words(static_cast<std::size_t>(jump.guards.numel()));
  const int state = turned_state(system, jump);
  if (state < 0 || jump.value.numel() != 1) return words;
  const SX from_0 = condition_at(system, jump, state, 0.0), from_1 = condition_at(system, jump, state, 1.0);
  for (casadi_int i = 0; i < jump.guards.numel(); ++i) {
    const SX selection = jump.guard_alpha(i);
    const bool on = SX::depends_on(from_0, selection), off = SX::depends_on(from_1, selection);
    if (on != off) words[at(i)] = on ? "on" : "off";
  }
  return words;
}

}  // namespace saltus::evaluation
