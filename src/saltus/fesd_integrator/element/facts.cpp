#include "saltus/fesd_integrator/element/facts.hpp"

#include "saltus/base/at.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::fesd_integrator {
namespace {

std::string region_name(const model::System& system, const reformulation::Dcs& dcs, const reformulation::DcsPart& part,
                        int region) {
  if (part.mode_group >= 0) {
    const auto& group = system.mode_groups[at(part.mode_group)];
    const std::string& mode = group.mode_names[at(region)];
    return group.name.empty() ? mode : group.name + "." + mode;
  }
  std::string sides;
  for (std::size_t j = 0; j < part.surfaces.size(); ++j) {
    if (j > 0) sides += ", ";
    const bool above = part.signs(region, static_cast<linalg::Index>(j)) > 0;
    sides += dcs.surfaces[at(part.surfaces[j])].name + (above ? " > 0" : " < 0");
  }
  return sides;
}

}  // namespace

Facts facts(const model::System& system, const reformulation::Dcs& dcs) {
  Facts facts;
  facts.n_x = static_cast<std::size_t>(system.x.numel());
  facts.n_u = static_cast<std::size_t>(system.u.numel());
  facts.n_y = static_cast<std::size_t>(system.outputs.numel());
  facts.n_functions = system.switching.size();
  facts.initial_state = system.initial_state;
  facts.state_names = system.state_names;
  for (const auto& part : dcs.parts) {
    const bool simplex = part.form == reformulation::Form::stewart;
    facts.parts.push_back({simplex, part.first, part.count, simplex ? static_cast<int>(part.surfaces.size()) : 0});
    for (int i = 0; i < part.count; ++i) {
      if (simplex) {
        facts.selections.push_back({region_name(system, dcs, part, i), result::SelectionForm::stewart});
      } else {
        const int surface = part.surfaces[at(i)];
        facts.selections.push_back({dcs.surfaces[at(surface)].name, result::SelectionForm::step});
      }
    }
  }
  for (const auto& column : system.columns) {
    const auto& function = system.switching[at(column.function)];
    facts.columns.push_back(
        {column.name, column.function, column.orientation, function.role == model::SwitchingRole::listed});
  }
  for (const auto& group : system.mode_groups) {
    if (group.first >= 0) facts.regions.push_back({group.first, group.mode_names});
  }
  for (const auto& symbol : dcs.held_symbols) {
    const bool cell = symbol.kind == reformulation::HeldSymbol::Kind::cell;
    facts.held.push_back({cell, cell ? system.cells[at(symbol.index)].table : nullptr, symbol.column, symbol.at_zero});
  }
  for (const auto& event : dcs.events) {
    facts.events.push_back({event.name, model::rule_of(event), event.action == model::AtEvent::stop});
  }
  return facts;
}

}  // namespace saltus::fesd_integrator
