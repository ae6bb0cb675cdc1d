#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/evaluation/jump_functions_internal.hpp"

namespace saltus::evaluation {

using casadi::SX;

JumpFunctions::JumpFunctions(const model::System& system, const std::vector<SX>& arguments, const SX& input,
                             int first_function) {
  const auto with = [&](const SX& inputs, const SX& expression) {
    return system.u.numel() == 0 ? expression : SX::substitute(expression, system.u, inputs);
  };
  const SX input_at_instant = SX::densify(system.input_at_instant);
  int next = first_function;
  // Named by the jump: they become native code together.
  const auto numbered = [&](const char* name) { return fmt::format("saltus_jump{}_{}", entries_.size(), name); };
  const auto quantity = [&](const char* name, const SX& expression) {
    const SX value = SX::densify(with(input_at_instant, expression));
    return value.is_constant() ? Quantity{static_cast<double>(value), {}}
                               : Quantity{std::nullopt, ModelFunction(numbered(name), arguments, {value})};
  };
  for (const auto& jump : system.jumps) {
    Entry entry;
    entry.first_guard = next;
    entry.guards = static_cast<int>(jump.guards.numel());
    next += entry.guards;
    if (jump.trigger == model::JumpTrigger::condition) {
      std::vector<SX> with_guards = arguments;
      with_guards.push_back(jump.guard_alpha);
      entry.condition = ModelFunction(numbered("condition"), with_guards, {with(input, jump.value)});
    }
    entry.values = ModelFunction(numbered("values"), arguments, {with(input_at_instant, jump.values)});
    entry.priority = quantity("priority", jump.priority);
    entry.delay = quantity("delay", jump.delay);
    entries_.push_back(std::move(entry));
  }
}

std::vector<ModelFunction*> JumpFunctions::functions() {
  std::vector<ModelFunction*> all;
  for (auto& entry : entries_) {
    for (auto* function : {&entry.condition, &entry.values, &entry.priority.function, &entry.delay.function}) {
      if (!function->is_null()) all.push_back(function);
    }
  }
  return all;
}

double JumpFunctions::value(Quantity& quantity, const Arguments& at) {
  if (quantity.constant) return *quantity.constant;
  double value = 0.0;
  quantity.function(at, std::array<double*, 1>{&value});
  return value;
}

JumpFunctions::Entry& JumpFunctions::entry(int jump) {
  SALTUS_ASSERT(0 <= jump && jump < static_cast<int>(entries_.size()));
  return entries_[at(jump)];
}

int JumpFunctions::guard(int jump, int guard) const {
  SALTUS_ASSERT(0 <= jump && jump < static_cast<int>(entries_.size()));
  const Entry& found = entries_[at(jump)];
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

double JumpFunctions::priority(int jump, const Arguments& at) { return value(entry(jump).priority, at); }
double JumpFunctions::delay(int jump, const Arguments& at) { return value(entry(jump).delay, at); }

}  // namespace saltus::evaluation
