#include <string>
#include <vector>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/io/check/jump_words_internal.hpp"
#include "saltus/io/check/model_overview.hpp"

namespace saltus::io {
namespace {

using result::StatedEquation;

/// Collects equations until there are enough.
class EquationList {
 public:
  explicit EquationList(std::size_t most) : most_(most) {}

  void add(std::string left, const expression::NodePtr& right, std::string where = "") {
    if (!right || list_.size() >= most_) return;
    list_.push_back({std::move(left), expression::to_spaced_text(*right), std::move(where)});
  }
  void add(const std::vector<model::NamedExpression>& entries, const char* mark, const std::string& where = "") {
    for (const auto& entry : entries) {
      if (list_.size() >= most_) return;
      add(entry.name + mark, entry.expression, where);
    }
  }
  [[nodiscard]] std::vector<StatedEquation> take() { return std::move(list_); }

 private:
  std::size_t most_;
  std::vector<StatedEquation> list_;
};

void add_mechanics(const model::Description& description, EquationList& equations) {
  if (!description.mechanics) return;
  const auto& mechanics = *description.mechanics;
  for (std::size_t i = 0; i < mechanics.mass.size(); ++i) {
    for (std::size_t j = 0; j < mechanics.mass[i].size(); ++j) {
      equations.add(fmt::format("M[{}, {}]", i + 1, j + 1), mechanics.mass[i][j]);
    }
  }
  equations.add("potential", mechanics.potential);
  for (const auto& force : mechanics.force) equations.add("force on " + force.velocity, force.force);
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

}  // namespace

std::vector<StatedEquation> stated_equations(const model::Description& description, std::size_t most) {
  EquationList equations(most);
  equations.add(description.dynamics, "'");
  add_mechanics(description, equations);
  for (const auto& mode : description.modes) equations.add(mode.dynamics, "'", place_of(mode));
  equations.add(description.definitions, "");
  equations.add(description.switching, "", "switching function");
  for (const auto& jump : description.jumps) equations.add(jump.set, " becomes", when_text(jump));
  for (const auto& relay : description.hysteresis) {
    equations.add("input of " + relay.name, relay.input,
                  fmt::format("1 from {}, 0 from {}", expression::to_spaced_text(*relay.on),
                              expression::to_spaced_text(*relay.off)));
  }
  equations.add(description.outputs, "", "output");
  return equations.take();
}

}  // namespace saltus::io
