// A model stated in C++ whose time stands still at contacts and hysteresis.
#include <algorithm>

#include "saltus/model/builder_parts_internal.hpp"
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

/// Puts into a statement what selections became.
class Restatement {
 public:
  explicit Restatement(const std::vector<std::pair<SXElem, SXElem>>& selections) {
    for (const auto& [before, now] : selections) {
      before_.emplace_back(before);
      now_.emplace_back(now);
    }
  }

  void apply(SX& e) const {
    if (before_.empty() || e.is_empty()) return;
    std::vector<SX> one{e};
    e = SX::substitute(one, before_, now_).front();
  }
  void apply(SXElem& e) const {
    SX one(e);
    apply(one);
    e = SX::densify(one).scalar();
  }

  void apply(Condition& condition) const { condition = restated(condition); }

  void apply(Statement& whole) const {
    for (auto& state : whole.states) {
      if (state.dynamics) apply(*state.dynamics);
    }
    for (auto& group : whole.mode_groups) {
      for (auto& mode : group.modes) {
        if (mode.when) apply(*mode.when);
        if (mode.indicator) apply(*mode.indicator);
        for (auto& rate : mode.rates) apply(rate.rate);
      }
    }
    for (auto* outputs : {&whole.outputs, &whole.automatic_outputs}) {
      for (auto& output : *outputs) apply(output.expression);
    }
    for (auto& event : whole.events) {
      if (event.expression) apply(*event.expression);
      if (event.condition) apply(*event.condition);
    }
  }

  void apply(FreezingPlan& plan) const {
    for (auto& [state, rate] : plan.added) apply(rate);
    apply(plan.waits);
    apply(plan.moves);
  }

 private:
  [[nodiscard]] Condition restated(const Condition& condition) const {
    switch (condition.kind()) {
      case Condition::Kind::constant:
        break;
      case Condition::Kind::comparison: {
        Comparison comparison = condition.comparison();
        apply(comparison.difference);
        return Condition(comparison);
      }
      case Condition::Kind::negation:
        return !restated(condition.left());
      case Condition::Kind::conjunction:
        return restated(condition.left()) && restated(condition.right());
      case Condition::Kind::disjunction:
        return restated(condition.left()) || restated(condition.right());
    }
    return condition;
  }

  std::vector<SX> before_, now_;
};

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
    recognised.take_as_two_valued(whole.states[at(stated.state)].symbol);
    std::erase_if(whole.jumps, [&](const JumpStatement& jump) { return jump.name == stated.thresholds.name; });
  }
  const auto selections = recognised.restated_selections();
  if (!selections) return tl::unexpected(selections.error());
  const Restatement restatement(*selections);
  restatement.apply(whole);
  for (const auto& stated : hysteresis) {
    recognised.restate_as_state(whole.states[at(stated.state)].symbol, stated.state);
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

  if (auto mistake = add_modes(recognised, whole)) return tl::unexpected(*mistake);
  for (const auto& stated : hysteresis) {
    SXElem input = stated.input;
    restatement.apply(input);
    auto mistake = freeze_hysteresis(recognised, whole, stated.state, input, stated.thresholds, plan);
    if (mistake) return tl::unexpected(*mistake);
  }
  const auto take = [&](const auto& touched, const auto& motion) {
    return freeze_contacts(recognised, whole, touched, motion, plan);
  };
  if (auto mistake = add_mechanics(recognised, whole, take)) return tl::unexpected(*mistake);
  restatement.apply(whole);  // what mechanics added
  restatement.apply(plan);
  freeze_rates(whole, plan);
  auto system = assemble(recognised, whole);
  if (!system) return system;
  find_selections(*system, plan);
  system->freezing = std::make_shared<const TimeFreezing>(plan.made);
  return system;
}

}  // namespace saltus::model
