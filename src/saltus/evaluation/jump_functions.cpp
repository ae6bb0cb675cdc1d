#include "saltus/base/contracts.hpp"
#include "saltus/evaluation/jump_functions_internal.hpp"

namespace saltus::evaluation {

using casadi::SX;

JumpFunctions::JumpFunctions(const model::System& system, const std::vector<SX>& arguments, const SX& input,
                             int first_function) {
  const auto with_inputs = [&](const SX& expression) {
    return system.u.numel() == 0 ? expression : SX::substitute(expression, system.u, input);
  };
  int next = first_function;
  for (const auto& jump : system.jumps) {
    Entry entry;
    entry.first_guard = next;
    entry.guards = static_cast<int>(jump.guards.numel());
    next += entry.guards;
    if (jump.trigger == model::JumpTrigger::condition) {
      std::vector<SX> with_guards = arguments;
      with_guards.push_back(jump.guard_alpha);
      entry.condition = ModelFunction("jump_condition", with_guards, {with_inputs(jump.value)});
    }
    entry.values = ModelFunction("jump_values", arguments, {with_inputs(jump.values)});
    entry.priority = ModelFunction("jump_priority", arguments, {with_inputs(jump.priority)});
    entry.delay = ModelFunction("jump_delay", arguments, {with_inputs(jump.delay)});
    entries_.push_back(std::move(entry));
  }
}

JumpFunctions::Entry& JumpFunctions::entry(int jump) {
  SALTUS_ASSERT(0 <= jump && jump < static_cast<int>(entries_.size()));
  return entries_[static_cast<std::size_t>(jump)];
}

int JumpFunctions::guard(int jump, int guard) const {
  SALTUS_ASSERT(0 <= jump && jump < static_cast<int>(entries_.size()));
  const Entry& found = entries_[static_cast<std::size_t>(jump)];
  SALTUS_ASSERT(0 <= guard && guard < found.guards);
  return found.first_guard + guard;
}

bool JumpFunctions::condition(int jump, const Arguments& at, const double* guard_alpha) {
  auto& function = entry(jump).condition;
  SALTUS_ASSERT(!function.is_null());
  double value = 0.0;
  function(std::array<const double*, 5>{at[0], at[1], at[2], at[3], guard_alpha}, std::array<double*, 1>{&value});
  return value > 0.5;
}

void JumpFunctions::values(int jump, const Arguments& at, double* values) {
  entry(jump).values(at, std::array<double*, 1>{values});
}

double JumpFunctions::priority(int jump, const Arguments& at) {
  double value = 0.0;
  entry(jump).priority(at, std::array<double*, 1>{&value});
  return value;
}

double JumpFunctions::delay(int jump, const Arguments& at) {
  double value = 0.0;
  entry(jump).delay(at, std::array<double*, 1>{&value});
  return value;
}

}  // namespace saltus::evaluation
