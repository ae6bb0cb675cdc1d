// What a kernel says of its system without expressions: names, and where a run begins.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/model/layout_of.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

using casadi::SX;

/// What discrete guards and functions read is asked of the expressions as they are stated; which guards are discrete is
/// known when the inputs are put in.
void CompiledModel::find_layout(const model::System& system) {
  model::Layout layout = model::layout_of(system);
  std::vector<SX> rows;
  std::vector<std::vector<int>*> reads;
  for (std::size_t j = 0; j < layout.surfaces.size(); ++j) {
    if (layout.surfaces[j].role != model::SwitchingRole::discrete) continue;
    rows.push_back(system.switching[j].psi);
    reads.push_back(&layout.surfaces[j].states);
  }
  int next = n_psi + static_cast<int>(std::count_if(layout.events.begin(), layout.events.end(),
                                                    [](const auto& event) { return !event.is_condition(); }));
  for (auto& event : layout.events) {
    for (auto& guard : event.guards) guard.function = next++;
  }
  SALTUS_ASSERT(next == first_jump_guard);
  for (std::size_t k = 0; k < layout.jumps.size(); ++k) {
    auto& guards = layout.jumps[k].guards;
    for (std::size_t g = 0; g < guards.size(); ++g) {
      guards[g].function = next++;
      guards[g].discrete = discrete_guards[at(guards[g].function)];
      if (!guards[g].discrete) continue;
      rows.push_back(system.jumps[k].guards(static_cast<casadi_int>(g)));
      reads.push_back(&guards[g].states);
    }
  }
  if (!rows.empty()) {
    auto states = dependencies_of_rows(SX::vertcat(rows), x);
    for (std::size_t i = 0; i < reads.size(); ++i) *reads[i] = std::move(states[i]);
  }
  start.initial_state = system.initial_state;
  start.system = std::make_shared<const model::System>(system);
  start.layout = std::make_shared<const model::Layout>(std::move(layout));
}

model::Layout CompiledModel::layout_with_parts(const model::System& system) const {
  model::Layout layout = model::layout_of(system);
  const auto take = [](const std::vector<model::Layout::Guard>& known, std::vector<model::Layout::Guard>& guards) {
    SALTUS_ASSERT(known.size() == guards.size());
    for (std::size_t g = 0; g < guards.size(); ++g) {
      const bool true_at_equality = guards[g].true_at_equality;
      guards[g] = known[g];
      guards[g].true_at_equality = true_at_equality;
    }
  };
  const auto& known = *start.layout;
  for (std::size_t j = 0; j < layout.surfaces.size(); ++j) layout.surfaces[j].states = known.surfaces[j].states;
  for (std::size_t e = 0; e < layout.events.size(); ++e) take(known.events[e].guards, layout.events[e].guards);
  for (std::size_t k = 0; k < layout.jumps.size(); ++k) take(known.jumps[k].guards, layout.jumps[k].guards);
  return layout;
}

const model::Layout& ModelKernel::layout() const { return *implementation_->layout; }
const model::System& ModelKernel::stated() const { return *implementation_->system; }
const std::vector<double>& ModelKernel::initial_state() const { return implementation_->initial_state; }

void ModelKernel::set_initial_state(std::vector<double> x) { implementation_->initial_state = std::move(x); }

bool ModelKernel::set_values(const model::System& system) {
  auto& self = *implementation_;
  const auto& values = system.parameter_values;
  SALTUS_ASSERT(values.size() == self.compiled->fixed_parameters);
  if (self.compiled->by_values || !self.limited.empty() || !self.regions.groups().empty()) return false;
  std::copy(values.begin(), values.end(), self.parameters.begin());
  for (int cell = 0; cell < self.cells.size(); ++cell) self.cells.move(cell, 0, self.parameters);
  set_activities(std::vector<model::Activity>(self.activities.size()));
  self.constant_gradients.reset();
  self.free.linear_always.reset();
  for (auto& [functions, motion] : self.held) motion.linear_always.reset();
  self.field_use.motion = self.motion = &self.free;
  self.initial_state = system.initial_state;
  self.layout = std::make_shared<const model::Layout>(self.compiled->layout_with_parts(system));
  const SymbolicLock lock;
  self.system = std::make_shared<const model::System>(system);
  return true;
}

}  // namespace saltus::evaluation
