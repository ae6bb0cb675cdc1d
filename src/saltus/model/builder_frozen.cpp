// A model stated in C++ whose time stands still at contacts and hysteresis.
#include <algorithm>

#include "saltus/model/builder_parts_internal.hpp"
#include "saltus/model/graph/sharing_internal.hpp"
#include "saltus/model/statement/build_errors_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

Error no_frozen_form(std::string message, std::string remedy) {
  return {ErrorCode::not_available, std::move(message), std::move(remedy), {}, {}};
}

/// Inputs and cells that move with t, which is a state by then.
std::optional<Error> take_inputs(Recognition& recognition, Statement& whole, FrozenFor purpose) {
  for (auto& control : whole.controls) {
    if (!control.input || recognition.parameter_value(*control.input)) continue;
    if (purpose == FrozenFor::simulation) return moving_input(control.name, {});
    control.input.reset();  // optimised, it has none
  }
  for (const auto& cell : recognition.graph.cells()) {
    const int argument = recognition.graph.node(cell.argument);
    if ((recognition.graph.tape()[argument].reached & kind_bit(VariableKind::time)) == 0) continue;
    if (purpose == FrozenFor::optimisation && cell.argument.is_symbolic()) continue;  // of an input that is dropped
    return no_frozen_form(fmt::format("'{}' changes with t: time-freezing does not cover that", cell.name),
                          "simulate with Method::event");
  }
  return std::nullopt;
}

/// Discrete functions of a hysteresis that are the same but for their value at 0: == and !=, > beside >=.
std::optional<Error> find_equalities(const Recognition& recognition) {
  std::vector<int> psi;
  for (const auto& met : recognition.functions()) psi.push_back(met.psi_node);
  const auto first = first_multiples(recognition.graph.tape(), psi);
  for (std::size_t i = 0; i < psi.size(); ++i) {
    if (first[i] == i) continue;
    return no_frozen_form(
        fmt::format("'{}' is compared in two ways, and moves while time stands still", recognition.functions()[i].name),
        "compare a hysteresis with 0.5, by > or <, in one way");
  }
  return std::nullopt;
}

}  // namespace

Expected<System> Builder::Parts::frozen(FrozenFor purpose) {
  FreezingPlan plan;
  plan.purpose = purpose;
  plan.numbers = freezing;
  return frozen_copy(recognition, statement, std::move(plan));
}

Expected<System> Builder::Parts::frozen_copy(Recognition recognised, Statement whole, FreezingPlan plan) {
  if (auto mistake = take_inputs(recognised, whole, plan.purpose)) return tl::unexpected(*mistake);
  for (const auto& stated : hysteresis) {
    plan.made.hysteresis.push_back({stated.thresholds.name, stated.state});
    recognised.restate_as_state(whole.states[at(stated.state)].symbol, stated.state);
    std::erase_if(whole.jumps, [&](const JumpStatement& jump) { return jump.name == stated.thresholds.name; });
  }
  std::vector<ContactToFreeze> touching;
  for (const auto& [name, options] : contacts) {
    const SXElem restitution = entry(options.restitution, "restitution of " + name);
    recognised.note({.kind = Decision::Kind::value, .node = recognised.graph.node(restitution)},
                    [&, &contact = name] { return "the restitution of '" + contact + "'"; });
    touching.push_back({name, recognised.parameter_value(restitution).value_or(0.0), !options.second_tangent.empty()});
  }
  declare_hidden(recognised, whole, touching, plan);
  const auto by_indicator = [](const auto& group) { return group.by_indicator(); };
  const auto& groups = whole.mode_groups;
  plan.takes_plane = plan.takes_plane && std::none_of(groups.begin(), groups.end(), by_indicator);
  // The symbol of t is that of the clock from now on.
  plan.made.clock = static_cast<int>(whole.states.size());
  recognised.restate_as_state(whole.time, plan.made.clock);
  whole.states.push_back({.name = clock_name, .symbol = whole.time, .dynamics = SXElem(0.0)});
  plan.numerical_time = recognised.graph.symbol("t", {.kind = VariableKind::time});
  if (auto mistake = find_equalities(recognised)) return tl::unexpected(*mistake);

  if (auto mistake = add_modes(recognised, whole)) return tl::unexpected(*mistake);
  for (const auto& stated : hysteresis) {
    auto mistake = freeze_hysteresis(recognised, whole, stated.state, stated.input, stated.thresholds, plan);
    if (mistake) return tl::unexpected(*mistake);
  }
  const auto take = [&](const auto& touched, const auto& motion) {
    return freeze_contacts(recognised, whole, touched, motion, plan);
  };
  if (auto mistake = add_mechanics(recognised, whole, take)) return tl::unexpected(*mistake);
  freeze_rates(whole, plan);
  auto system = assemble(recognised, whole);
  if (!system) return system;
  find_selections(*system, plan);
  system->freezing = std::make_shared<const TimeFreezing>(plan.made);
  return system;
}

}  // namespace saltus::model
