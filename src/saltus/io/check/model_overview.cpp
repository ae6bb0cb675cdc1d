#include "saltus/io/check/model_overview.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/base/enum_names.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/check/jump_words_internal.hpp"
#include "saltus/model/summary.hpp"

namespace saltus::io {
namespace {

using expression::NodePtr;
using expression::to_spaced_text;

std::vector<OverviewEquation> equations_of(const std::vector<model::NamedExpression>& entries,
                                           const result::Captions& captions = {}) {
  std::vector<OverviewEquation> equations;
  for (const auto& entry : entries)
    equations.push_back({entry.name, to_spaced_text(*entry.expression), caption_of(captions, entry.name)});
  return equations;
}

/// q' = v, and for the velocities what is beside M v'.
void add_motion(const model::MechanicsDescription& mechanics, std::vector<OverviewEquation>& equations) {
  const std::size_t n = std::min(mechanics.positions.size(), mechanics.velocities.size());
  for (std::size_t i = 0; i < n; ++i) {
    equations.push_back({mechanics.positions[i].name, mechanics.velocities[i].name, {}});
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto& velocity = mechanics.velocities[i].name;
    const auto stated = std::find_if(mechanics.force.begin(), mechanics.force.end(),
                                     [&](const auto& force) { return force.velocity == velocity; });
    std::string force = stated == mechanics.force.end() ? "" : to_spaced_text(*stated->force);
    if (mechanics.potential) {
      force += fmt::format("{}d({})/d{}", force.empty() ? "-" : " - ", to_spaced_text(*mechanics.potential),
                           mechanics.positions[i].name);
    }
    if (force.empty()) force = "0";
    const bool has_mass = !mechanics.mass.empty();
    equations.push_back({velocity, has_mass ? fmt::format("(M^-1 F)[{0}], F[{0}] = {1}", velocity, force) : force, {}});
  }
}

std::string contact_text(const model::ContactDescription& contact) {
  std::string text = fmt::format("gap {}", to_spaced_text(*contact.gap));
  for (const auto& tangent : contact.tangents) {
    std::vector<std::string> entries;
    for (const auto& entry : tangent) {
      entries.push_back(fmt::format("{} = {}", entry.position, to_spaced_text(*entry.value)));
    }
    text += fmt::format(", tangent {{ {} }}", fmt::join(entries, ", "));
  }
  if (contact.friction) text += fmt::format(", friction {}", to_spaced_text(*contact.friction));
  return text + fmt::format(", restitution {}", contact.restitution ? to_spaced_text(*contact.restitution) : "0");
}

std::string remark_of(const model::Layout& layout, std::size_t state) {
  if (!layout.discrete_states[state]) return "";
  for (const auto& jump : layout.jumps) {
    const auto target = std::find(jump.targets.begin(), jump.targets.end(), static_cast<int>(state));
    if (target != jump.targets.end()) return "discrete: changed by jumps only";
  }
  return "constant: its right-hand side is 0 and no jump sets it";
}

void take_quantities(const model::Summary& system, const result::Captions& captions, ModelOverview& overview) {
  const auto& layout = system.layout;
  for (std::size_t i = 0; i < layout.state_names.size(); ++i) {
    overview.states.push_back({layout.state_names[i], system.initial_state[i], system.state_lower[i],
                               system.state_upper[i], caption_of(captions, layout.state_names[i]),
                               remark_of(layout, i)});
  }
  for (std::size_t i = 0; i < layout.parameter_names.size(); ++i) {
    overview.parameters.push_back({layout.parameter_names[i], system.parameter_values[i], -INFINITY, INFINITY,
                                   caption_of(captions, layout.parameter_names[i])});
  }
  for (std::size_t i = 0; i < layout.control_names.size(); ++i) {
    overview.controls.push_back({layout.control_names[i], system.control_initial[i], system.control_lower[i],
                                 system.control_upper[i], caption_of(captions, layout.control_names[i])});
  }
}

std::vector<OverviewMode> modes_of(const model::Description& description) {
  std::vector<OverviewMode> modes;
  for (const auto& mode : description.modes) {
    const auto in_group = [&](const OverviewMode& other) { return other.group == mode.group; };
    const auto position = 1 + std::count_if(modes.begin(), modes.end(), in_group);
    modes.push_back(
        {mode.group, mode.when ? "" : mode.name.value_or(fmt::format("mode{}", position)),
         mode.when ? to_spaced_text(*mode.when) : fmt::format("indicator {}", to_spaced_text(*mode.indicator)),
         equations_of(mode.dynamics)});
  }
  return modes;
}

constexpr EnumNames<model::SwitchingRole::region> roles("listed", "kink", "time event", "discrete", "region");

/// What happens on a surface, in words.
std::string meaning_of(const model::Layout::Surface& function, const std::vector<std::string>& rates) {
  const std::string who = rates.empty() ? "nothing" : fmt::format("{}'", fmt::join(rates, "', "));
  switch (function.role) {
    case model::SwitchingRole::listed:
      return rates.empty() ? "a column of the result" : fmt::format("{} may jump there", who);
    case model::SwitchingRole::kink:
      return rates.empty() ? "the integrator restarts there, nothing slides"
                           : fmt::format("{} {} a corner there: the integrator restarts, nothing slides", who,
                                         rates.size() == 1 ? "has" : "have");
    case model::SwitchingRole::time_event:
      return "the integrator restarts there";
    case model::SwitchingRole::discrete:
      return "changed by jumps only, nothing slides";
    case model::SwitchingRole::region:
      return "where its indicator is the smallest of its group";
  }
  __builtin_unreachable();
}

/// The expressions behind names of [switching] and [definitions]; an unnamed function is its own text.
class NamedFunctions {
 public:
  explicit NamedFunctions(const model::Description& description) {
    for (const auto* table : {&description.switching, &description.definitions}) {
      for (const auto& entry : *table) expressions_.emplace(entry.name, entry.expression.get());
    }
  }
  [[nodiscard]] std::string expression_of(const std::string& name) const {
    if (const auto found = expressions_.find(name); found != expressions_.end()) return to_spaced_text(*found->second);
    const auto parsed = expression::parse(name, {});
    return parsed ? to_spaced_text(**parsed) : name;
  }

 private:
  std::unordered_map<std::string, const expression::Node*> expressions_;
};

std::vector<OverviewSurface> surfaces_of(const model::Description& description, const model::Summary& system) {
  const auto& layout = system.layout;
  const NamedFunctions functions(description);
  std::vector<OverviewSurface> all;
  for (std::size_t j = 0; j < layout.surfaces.size(); ++j) {
    const auto& function = layout.surfaces[j];
    OverviewSurface surface{
        function.name, functions.expression_of(function.name), std::string(roles(function.role)), "", {}, {}, "",
        false};
    for (const int state : system.switched_rates[j]) surface.rates.push_back(layout.state_names[at(state)]);
    for (const int index : system.inner[j]) surface.inner.push_back(layout.surfaces[at(index)].name);
    surface.meaning = meaning_of(function, surface.rates);
    all.push_back(std::move(surface));
  }
  std::vector<OverviewSurface> ordered;
  std::vector<bool> shown(all.size(), false);
  for (const auto& column : layout.columns) {
    const auto& function = all[at(column.function)];
    ordered.push_back(function);
    if (column.name != function.name) {
      ordered.back().name = column.name;
      ordered.back().expression = functions.expression_of(column.name);
      ordered.back().alias_of = function.name;
      ordered.back().swapped = column.orientation < 0;
    }
    shown[at(column.function)] = true;
  }
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (!shown[j]) ordered.push_back(all[j]);
  }
  return ordered;
}

std::string cell_text(const model::CellTable& table) {
  if (table.kind == model::CellTable::Breaks::integers) return "jumps at whole numbers of its argument";
  const auto breaks = table.breaks.size();
  return fmt::format("{} at {} break{}", table.change == model::CellTable::Change::jump ? "jumps" : "kinks", breaks,
                     breaks == 1 ? "" : "s");
}

}  // namespace

ModelOverview overview_of(const model::Description& description, const model::Summary& system,
                          const result::Captions& captions) {
  const auto& layout = system.layout;
  ModelOverview overview;
  overview.name = layout.name;
  overview.description = system.description;
  take_quantities(system, captions, overview);
  overview.equations = equations_of(description.dynamics);
  if (description.mechanics) add_motion(*description.mechanics, overview.equations);
  for (const auto& contact : description.contacts) {
    overview.contacts.push_back({contact.name, contact_text(contact), {}});
  }
  overview.modes = modes_of(description);
  overview.definitions = equations_of(description.definitions, captions);
  overview.outputs = equations_of(description.outputs, captions);
  overview.surfaces = surfaces_of(description, system);
  for (std::size_t i = 0; i < layout.cell_names.size(); ++i) {
    overview.cells.push_back({layout.cell_names[i], cell_text(*system.cell_tables[i])});
  }
  for (std::size_t i = 0; i < layout.events.size(); ++i) {
    overview.events.push_back({layout.events[i].name, to_spaced_text(*description.events[i].when),
                               layout.events[i].action == model::AtEvent::stop});
  }
  for (std::size_t i = 0; i < description.jumps.size(); ++i) {
    overview.jumps.push_back(
        {layout.jumps[i].name, when_text(description.jumps[i]), equations_of(description.jumps[i].set)});
  }
  for (const auto& entry : description.hysteresis) {
    overview.jumps.push_back({entry.name,
                              fmt::format("on at {} = {}, off at {}", to_spaced_text(*entry.input),
                                          to_spaced_text(*entry.on), to_spaced_text(*entry.off)),
                              {{entry.name, fmt::format("1 - {}", entry.name), {}}}});
  }
  overview.inclusion = layout.inclusion == model::Inclusion::filippov ? "filippov" : "aizerman_pyatnitskii";
  overview.multi_affine = layout.multi_affine;
  overview.inclusion_differences = system.inclusion_differences;
  overview.warnings = system.warnings;
  return overview;
}

}  // namespace saltus::io
