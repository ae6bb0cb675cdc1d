#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "saltus/expression/latex.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/check/jump_words_internal.hpp"
#include "saltus/io/check/model_overview.hpp"

namespace saltus::io {
namespace {

using result::StatedEquation;

/// Collects equations until there are enough.
class EquationList {
 public:
  EquationList(std::size_t most, Notation notation) : most_(most), notation_(notation) {}

  /// A left side in words.
  void add(const std::string& left, const expression::NodePtr& right, std::string where = "") {
    if (!right || list_.size() >= most_) return;
    const bool is_text = notation_ == Notation::text;
    list_.push_back({is_text ? left : fmt::format("\\text{{{}}}", expression::latex_escaped(left)),
                     is_text ? expression::to_spaced_text(*right) : expression::to_latex(*right), std::move(where)});
  }
  /// Names, with what stands behind each: "'" for a derivative.
  void add(const std::vector<model::NamedExpression>& entries, const char* mark, const std::string& where = "") {
    for (const auto& entry : entries) {
      if (list_.size() >= most_) return;
      add(entry.name + mark, entry.expression, where);
      if (notation_ == Notation::text) continue;
      const auto name = expression::latex_name(entry.name);
      const std::string_view behind = mark;
      list_.back().left = behind == "'"    ? fmt::format("\\dot{{{}}}", name)
                          : behind.empty() ? name
                                           : fmt::format("{}\\text{{{}}}", name, behind);
    }
  }
  /// The derivative of one name is another one.
  void add_rate(const std::string& name, const std::string& rate) {
    if (list_.size() >= most_) return;
    const bool is_text = notation_ == Notation::text;
    list_.push_back({is_text ? name + "'" : fmt::format("\\dot{{{}}}", expression::latex_name(name)),
                     is_text ? rate : expression::latex_name(rate), ""});
  }
  [[nodiscard]] std::vector<StatedEquation> take() { return std::move(list_); }

 private:
  std::size_t most_;
  Notation notation_;
  std::vector<StatedEquation> list_;
};

/// q' = v, and the parts of M v' = F.
void add_mechanics(const model::MechanicsDescription& mechanics, EquationList& equations) {
  for (std::size_t i = 0; i < std::min(mechanics.positions.size(), mechanics.velocities.size()); ++i) {
    equations.add_rate(mechanics.positions[i].name, mechanics.velocities[i].name);
  }
  for (std::size_t i = 0; i < mechanics.mass.size(); ++i) {
    for (std::size_t j = 0; j < mechanics.mass[i].size(); ++j) {
      equations.add(fmt::format("M[{}, {}]", i + 1, j + 1), mechanics.mass[i][j]);
    }
  }
  equations.add("potential", mechanics.potential);
  for (const auto& force : mechanics.force) equations.add("force on " + force.velocity, force.force);
}

void add_contacts(const model::Description& description, EquationList& equations) {
  for (const auto& contact : description.contacts) {
    equations.add(fmt::format("gap({})", contact.name), contact.gap);
    for (const auto& tangent : contact.tangents) {
      for (const auto& entry : tangent) {
        equations.add(fmt::format("tangent({})[{}]", contact.name, entry.position), entry.value);
      }
    }
    equations.add(fmt::format("friction coefficient of {}", contact.name), contact.friction);
    equations.add(fmt::format("restitution of {}", contact.name), contact.restitution);
  }
}

std::string place_of(const model::ModeDescription& mode) {
  const auto group = mode.group.empty() ? "" : fmt::format("{}: ", mode.group);
  if (mode.when) return fmt::format("{}where {}", group, expression::to_spaced_text(*mode.when));
  return fmt::format("{}where {} is smallest", group, expression::to_spaced_text(*mode.indicator));
}

/// Whether an output is a definition under its own name, as `record` makes it.
bool is_definition(const model::Description& description, const model::NamedExpression& output) {
  return output.expression && expression::to_spaced_text(*output.expression) == output.name &&
         std::any_of(description.definitions.begin(), description.definitions.end(),
                     [&](const auto& definition) { return definition.name == output.name; });
}

}  // namespace

std::vector<StatedEquation> stated_equations(const model::Description& description, std::size_t most,
                                             Notation notation) {
  EquationList equations(most, notation);
  equations.add(description.dynamics, "'");
  if (description.mechanics) add_mechanics(*description.mechanics, equations);
  add_contacts(description, equations);
  for (const auto& mode : description.modes) equations.add(mode.dynamics, "'", place_of(mode));
  for (const auto& definition : description.definitions) {
    const bool recorded = std::any_of(description.outputs.begin(), description.outputs.end(), [&](const auto& output) {
      return output.name == definition.name && is_definition(description, output);
    });
    equations.add(std::vector{definition}, "", recorded ? "output" : "");
  }
  equations.add(description.switching, "", "switching function");
  for (const auto& jump : description.jumps) equations.add(jump.set, " becomes", when_text(jump));
  for (const auto& relay : description.hysteresis) {
    equations.add("input of " + relay.name, relay.input,
                  fmt::format("1 from {}, 0 from {}", expression::to_spaced_text(*relay.on),
                              expression::to_spaced_text(*relay.off)));
  }
  for (const auto& output : description.outputs) {
    if (!is_definition(description, output)) equations.add(std::vector{output}, "", "output");
  }
  return equations.take();
}

}  // namespace saltus::io
