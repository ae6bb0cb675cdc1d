// States that are 0 or 1 but where time stands still: what compares them is polynomials in them, not surfaces.
#include <algorithm>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {

/// NOTE: a surface at which such a state is 1/2 would be met while time stands still, beside the threshold that moves
/// the state: combinations of the four fields around that point are at rest there, and their clock is not.
void Recognition::take_as_two_valued(const SXElem& symbol) {
  const SXElem psi = symbol - 0.5;
  two_valued_.push_back(static_cast<int>(functions_.size()));
  MetFunction met{casadi::SX(psi).get_str(), psi, graph.node(psi), symbol, graph.node(symbol), false};
  functions_.push_back(std::move(met));
}

Expected<std::optional<BothValues>> Recognition::both_values(const SXElem& e) {
  const auto node = graph.add(e);
  if (!node) return tl::unexpected(node.error());
  if (two_valued_.empty()) return std::nullopt;
  const auto cone = graph.tape().cone(std::span(&*node, 1), Links::written);
  for (const int function : two_valued_) {
    const int state = functions_[at(function)].alpha_node;
    if (!contains(cone, state)) continue;
    return BothValues{function, graph.with_alphas(*node, {{state, 1.0}}), graph.with_alphas(*node, {{state, 0.0}})};
  }
  return std::nullopt;
}

std::string Recognition::text_at(const std::string& name, const BothValues& both, int value) const {
  if (name.empty()) return name;
  return fmt::format("{}, {} = {}", name, casadi::SX(functions_[at(both.function)].alpha).get_str(), value);
}

Expected<SXElem> Recognition::blended(const SXElem& e, const std::string& name, MakeSelection make) {
  const auto both = both_values(e);
  if (!both) return tl::unexpected(both.error());
  if (!*both) return make(e, name);
  const auto one = blended((*both)->at_one, text_at(name, **both, 1), make);
  if (!one) return one;
  const auto zero = blended((*both)->at_zero, text_at(name, **both, 0), make);
  if (!zero) return zero;
  return graph.blend(functions_[at((*both)->function)].alpha, *one, *zero);
}

Expected<Truth> Recognition::truth_at_both(TruthDiagram& diagram, const Comparison& comparison,
                                           const BothValues& both) {
  const auto truth_at = [&](const SXElem& difference, int value) {
    const std::string name = text_at(comparison.name, both, value);
    return comparison_truth(diagram, {difference, comparison.at_equality, name, comparison.sides});
  };
  const auto one = truth_at(both.at_one, 1);
  if (!one) return one;
  const auto zero = truth_at(both.at_zero, 0);
  if (!zero) return zero;
  return diagram.choice(diagram.literal(both.function), *one, *zero);
}

Expected<bool> Recognition::changes_by_jumps_only(const SXElem& expression) {
  const auto node = graph.add(expression);
  if (!node) return tl::unexpected(node.error());
  const Tape& tape = graph.tape();
  if ((tape[*node].reached & moving_kinds) == 0) return true;
  if (two_valued_.empty()) return false;
  const auto cone = tape.cone(std::span(&*node, 1), Links::through_alpha);
  return std::none_of(cone.begin(), cone.end(), [&](int leaf) {
    if (tape[leaf].variable < 0 || tape[leaf].operation == cell_operation) return false;
    const bool moves = (kind_bit(tape.variables()[at(tape[leaf].variable)].kind) & moving_kinds) != 0;
    return moves && std::none_of(two_valued_.begin(), two_valued_.end(),
                                 [&](int function) { return functions_[at(function)].alpha_node == leaf; });
  });
}

Expected<std::vector<std::pair<SXElem, SXElem>>> Recognition::restated_selections() {
  const std::vector<int> compare = functions_of_two_valued();
  // What is restated is met no more: surfaces of the states, on which they wait, are functions of their own.
  index_ = {};
  for (int i = 0; i < static_cast<int>(functions_.size()); ++i) {
    if (!contains(compare, i)) {
      index_.insert(graph.tape(), functions_[at(i)].psi_node, i);
    }
  }
  std::vector<std::pair<SXElem, SXElem>> restated;
  for (const int i : compare) {
    const MetFunction met = functions_[at(i)];  // a copy: more may be met below
    casadi::SX psi = met.psi;
    for (const auto& [before, now] : restated) psi = casadi::SX::substitute(psi, before, now);
    const auto make = [&](const SXElem& e, const std::string& name) -> Expected<SXElem> {
      const auto made = selection(e, name, met.alpha_at_zero);
      if (!made) return tl::unexpected(made.error());
      const bool is_zero = made->kind == Selection::Kind::constant && made->constant == 0.0;
      return is_zero ? SXElem(met.alpha_at_zero.value_or(0.5)) : value(*made);
    };
    const auto now = blended(psi.scalar(), met.name, make);
    if (!now) return tl::unexpected(now.error());
    restated.emplace_back(met.alpha, *now);
  }
  return restated;
}

std::vector<int> Recognition::functions_of_two_valued() const {
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(functions_.size()); ++i) {
    if (contains(two_valued_, i)) continue;
    const int psi = functions_[at(i)].psi_node;
    const auto cone = graph.tape().cone(std::span(&psi, 1), Links::through_alpha);
    const bool compares = std::any_of(two_valued_.begin(), two_valued_.end(), [&](int function) {
      return contains(cone, functions_[at(function)].alpha_node);
    });
    if (compares) found.push_back(i);
  }
  return found;
}

}  // namespace saltus::model
