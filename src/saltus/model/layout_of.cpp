#include "saltus/model/layout_of.hpp"

#include <cstddef>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {
namespace {

std::vector<Layout::Guard> guards_of(const casadi::SX& guards, const std::vector<bool>& true_at_equality) {
  std::vector<Layout::Guard> found(at(guards.numel()));
  for (std::size_t g = 0; g < found.size() && g < true_at_equality.size(); ++g) {
    found[g].true_at_equality = true_at_equality[g];
  }
  return found;
}

void add_switching(const System& system, Layout& layout) {
  for (const auto& function : system.switching) {
    layout.surfaces.push_back({function.name,
                               function.role,
                               function.is_kink(),
                               function.continuous,
                               function.alpha_at_zero,
                               {},
                               function.named});
  }
  layout.columns = system.columns;
  for (const auto& group : system.mode_groups) {
    layout.groups.push_back({group.name, group.regions, group.first, group.mode_names});
  }
}

void add_events(const System& system, Layout& layout) {
  for (const auto& event : system.events) {
    layout.events.push_back(
        {event.name, event.named, guards_of(event.guards, event.true_at_equality), event.direction, event.action});
  }
  for (const auto& jump : system.jumps) {
    layout.jumps.push_back({jump.name, jump.trigger, guards_of(jump.guards, jump.true_at_equality), jump.times,
                            jump.every, jump.targets, jump.at_start, jump.persistent, jump.evaluated, jump.forbidden});
  }
}

}  // namespace

Layout layout_of(const System& system) {
  Layout layout;
  layout.name = system.name;
  layout.state_names = system.state_names;
  layout.control_names = system.control_names;
  layout.parameter_names = system.parameter_names;
  layout.output_names = system.output_names;
  for (const auto& cell : system.cells) layout.cell_names.push_back(cell.name);
  layout.discrete_states = system.discrete_states;
  add_switching(system, layout);
  add_events(system, layout);
  layout.contacts = system.contacts.contacts;
  layout.positions = system.contacts.positions;
  layout.velocities = system.contacts.velocities;
  layout.inclusion = system.inclusion;
  layout.multi_affine = system.multi_affine;
  layout.affine_in_selections = system.inclusion == Inclusion::filippov || system.multi_affine;
  return layout;
}

}  // namespace saltus::model
