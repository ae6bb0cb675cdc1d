#include "saltus/model/build.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <string_view>
#include <unordered_set>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/model/hysteresis/hysteresis_internal.hpp"
#include "saltus/model/mechanics/mechanics_internal.hpp"
#include "saltus/model/mistakes.hpp"
#include "saltus/model/statement/build_errors_internal.hpp"
#include "saltus/model/statement/build_internal.hpp"
#include "saltus/model/statement/discrete_states_internal.hpp"
#include "saltus/model/statement/jumps_internal.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"
#include "saltus/model/time_freezing/freeze_internal.hpp"
#include "saltus/model/written_friction_internal.hpp"

namespace saltus::model {
namespace {
using expression::NodePtr;
using MaybeError = std::optional<Error>;
using Of = ComputedNumber::Of;

/// A description and its overrides on the way to a statement; one step per table.
class Build {
 public:
  Build(const Description& description, const std::vector<Override>& overrides, const Quantities* quantities,
        std::optional<FreezingPlan> freezing = std::nullopt)
      : description_(description),
        overrides_(overrides),
        quantities_(quantities),
        freezing_(std::move(freezing)),
        scope_(description, recognition_, statement_) {}

  [[nodiscard]] Expected<System> run() {
    if (auto error = state()) return tl::unexpected(*error);
    warn_of_unused();
    auto system = assemble(recognition_, statement_);
    if (!system || !freezing_) return system;
    find_selections(*system, *freezing_);
    system->freezing = std::make_shared<const TimeFreezing>(freezing_->made);
    return system;
  }

  /// Everything that can be told of it, one mistake or none beside another.
  [[nodiscard]] std::vector<Error> mistakes(bool is_whole) {
    std::vector<Error> found;
    scope_.collect_mistakes(found, is_whole);
    if (auto error = state()) static_cast<void>(scope_.end_at(std::move(*error)));
    if (is_whole) tell_of_still_states(found);
    if (scope_.has_mistakes()) return found;
    if (auto system = assemble(recognition_, statement_); !system) found.push_back(system.error());
    return found;
  }

 private:
  MaybeError state() {
    statement_.name = description_.name;
    statement_.description = description_.description;
    statement_.inclusion = description_.inclusion;
    statement_.time = recognition_.graph.symbol("t", {.kind = VariableKind::time});
    note_names(description_, scope_);
    if (quantities_ != nullptr) {
      for (const auto& entry : quantities_->expressions) scope_.note_names(entry.expression);
    }
    using Step = MaybeError (Build::*)();
    constexpr Step steps[] = {
        &Build::names,      &Build::overrides,        &Build::parameters,  &Build::controls,   &Build::states,
        &Build::bounds,     &Build::switching,        &Build::dynamics,    &Build::modes,      &Build::outputs,
        &Build::quantities, &Build::events,           &Build::jumps,       &Build::hysteresis, &Build::mechanics,
        &Build::inputs,     &Build::written_friction, &Build::definitions, &Build::freeze};
    for (const Step step : steps) {
      if (auto error = (this->*step)()) return error;
    }
    return std::nullopt;
  }

  /// Takes the entries one by one, up to the first mistake or to the end (ModelScope::end_at).
  template <class Entries, class Take>
  MaybeError take_each(const Entries& entries, Take take) {
    for (const auto& entry : entries) {
      prepares("reading the model", static_cast<std::size_t>(&entry - entries.data()), entries.size());
      MaybeError error = take(entry);
      if (error && (error = scope_.end_at(std::move(*error)))) return error;
    }
    return std::nullopt;
  }

  /// A state without right-hand side, which only the assembly refuses.
  void tell_of_still_states(std::vector<Error>& found) const {
    std::unordered_set<std::string_view> moved;
    for (const auto& rate : description_.dynamics) moved.insert(rate.name);
    for (const auto& mode : description_.modes) {
      for (const auto& rate : mode.dynamics) moved.insert(rate.name);
    }
    for (const auto& entry : description_.states) {
      if (!moved.contains(entry.name) && !is_mechanical(description_, entry.name))
        found.push_back(no_right_hand_side(entry.name, entry.location));
    }
  }

  MaybeError names() { return scope_.declare_names(); }

  MaybeError overrides() {
    for (const auto& entry : overrides_) {
      const Meaning* meaning = scope_.names().find(entry.name);
      const bool settable =
          meaning != nullptr && (meaning->kind == NameKind::parameter || meaning->kind == NameKind::state ||
                                 meaning->kind == NameKind::control || meaning->kind == NameKind::hysteresis);
      if (!settable) return not_settable(entry, meaning, scope_.names());
      const auto value = scope_.value(*entry.value, Reach::constants, fmt::format("the value of '{}'", entry.name));
      if (!value) return with_context(value.error(), fmt::format("in --set {}", entry.name));
      if (!std::isfinite(*value)) {
        return Error{ErrorCode::invalid_model,
                     fmt::format("the value of '{}' is {}, not a finite number", entry.name, *value),
                     "check the expression",
                     entry.value->location,
                     {fmt::format("in --set {}", entry.name)}};
      }
      set_values_[entry.name] = *value;
    }
    return std::nullopt;
  }

  /// The overriding value of a name, else that of its expression; `absent` without one.
  Expected<double> value_of(const std::string& name, const NodePtr& node, Reach reach, const std::string& what,
                            double absent, const ComputedNumber& computed) {
    if (const auto it = set_values_.find(name); it != set_values_.end()) return it->second;
    if (!node) return absent;
    return scope_.value(*node, reach, what, computed);
  }

  MaybeError parameters() {
    return take_each(description_.parameters, [&](const NamedExpression& entry) -> MaybeError {
      const int index = static_cast<int>(statement_.parameters.size());
      auto value = value_of(entry.name, entry.expression, Reach::earlier_parameters,
                            fmt::format("the parameter '{}'", entry.name), 0.0, {Of::parameters, index});
      if (value && !std::isfinite(*value)) {
        value = tl::unexpected(Error{ErrorCode::invalid_model,
                                     fmt::format("the parameter '{}' is {}, not a finite number", entry.name, *value),
                                     "check its expression and the parameters in it",
                                     entry.expression->location,
                                     {}});
      }
      if (!value) scope_.give_up(entry.name);
      // One that an optimisation chooses is a variable like a control: nothing folds at its value.
      const VariableKind kind = quantities_ != nullptr && quantities_->varying_parameters.contains(entry.name)
                                    ? VariableKind::control
                                    : VariableKind::parameter;
      const SXElem symbol =
          recognition_.graph.symbol(entry.name, {.kind = kind, .index = index, .value = value.value_or(1.0)});
      statement_.parameters.push_back({entry.name, symbol, value.value_or(1.0)});
      return value ? std::nullopt : MaybeError(value.error());
    });
  }

  MaybeError controls() {
    int index = 0;
    for (const auto& entry : description_.controls) {
      const auto same = [&](const auto& input) { return input.name == entry.name; };
      const auto& samples = description_.sampled_inputs;
      const bool sampled = std::any_of(samples.begin(), samples.end(), same) && !set_values_.contains(entry.name);
      const VariableKind kind = sampled ? VariableKind::sampled_control : VariableKind::control;
      const SXElem symbol = recognition_.graph.symbol(entry.name, {.kind = kind, .index = index++});
      statement_.controls.push_back({.name = entry.name, .symbol = symbol, .location = entry.location});
    }
    return std::nullopt;
  }

  MaybeError states() {
    const auto discrete = discrete_states(description_);
    int index = 0;
    for (const auto& entry : description_.states) {
      const VariableKind kind = discrete[at(index)] ? VariableKind::discrete : VariableKind::state;
      const SXElem symbol = recognition_.graph.symbol(entry.name, {.kind = kind, .index = index++});
      statement_.states.push_back({.name = entry.name, .symbol = symbol, .location = entry.location});
    }
    statement_.switching.resize(description_.switching.size());
    if (freezing_) return declare_frozen(description_, scope_, recognition_, statement_, *freezing_);
    declare_hysteresis(description_, recognition_, statement_);
    const auto numbers = freezing_numbers(description_, scope_);  // for their mistakes
    return numbers ? std::nullopt : MaybeError(numbers.error());
  }

  /// Initial values and bounds; they may use parameters, so all names must mean something first.
  MaybeError bounds() {
    const auto take = [&](const auto& entry, const std::string& kind, auto& stated, const ComputedNumber& computed) {
      auto error = range(entry, kind, stated.initial, stated.bounds, computed);
      recognition_.graph.set_value(state_variable(stated.symbol), stated.initial);
      return error;
    };
    int i = 0;
    auto error = take_each(description_.states, [&](const auto& entry) {
      const ComputedNumber computed{Of::initial_state, i};
      return take(entry, "state", statement_.states[at(i++)], computed);
    });
    if (error) return error;
    i = 0;
    return take_each(description_.controls,
                     [&](const auto& entry) { return take(entry, "control", statement_.controls[at(i++)], {}); });
  }

  int state_variable(const SXElem& symbol) {
    return recognition_.graph.tape()[recognition_.graph.node(symbol)].variable;
  }

  template <class Entry>
  MaybeError range(const Entry& entry, const std::string& kind, double& initial, Bounds& bounds,
                   const ComputedNumber& computed) {
    const std::string what = fmt::format("{} '{}'", kind, entry.name);
    const auto value = value_of(entry.name, entry.initial, Reach::everything,
                                fmt::format("the initial value of {}", what), 0.0, computed);
    if (!value) return value.error();
    initial = *value;
    for (const auto& [node, bound, side] :
         {std::tuple{&entry.lower, &bounds.lower, "lower"}, std::tuple{&entry.upper, &bounds.upper, "upper"}}) {
      if (!*node) continue;
      const auto limit =
          scope_.value(**node, Reach::everything, fmt::format("the {} bound of {}", side, what), std::nullopt);
      if (!limit) return limit.error();
      *bound = *limit;
    }
    const SourceLocation& place = entry.initial ? entry.initial->location : entry.location;
    return check_values(what, initial, bounds, place, statement_.warnings);
  }

  MaybeError switching() {
    int i = 0;
    return take_each(description_.switching, [&](const NamedExpression& entry) -> MaybeError {
      statement_.switching[at(i)].location = entry.location;
      statement_.switching[at(i)].referenced = scope_.is_used(entry.name);
      auto error = scope_.resolve_switching(i++);
      return error ? with_context(*error, fmt::format("in [switching] {}", entry.name)) : error;
    });
  }

  /// Behind the jumps, as are those of contacts: their numbers are those of the file.
  MaybeError hysteresis() {
    const auto take = [&](int state, const SXElem& input, const HysteresisThresholds& thresholds) {
      return freezing_ ? freeze_hysteresis(recognition_, statement_, state, input, thresholds, *freezing_)
                       : state_hysteresis(recognition_, statement_, state, input, thresholds);
    };
    return state_all_hysteresis(description_, scope_, set_values_, take);
  }

  MaybeError dynamics() {
    return take_each(description_.dynamics, [&](const NamedExpression& entry) -> MaybeError {
      const Meaning* meaning = scope_.names().find(entry.name);
      if (meaning == nullptr || meaning->kind != NameKind::state) {
        return scope_.is_given_up(entry.name) ? Error{} : no_such_state(entry, meaning, scope_.names());
      }
      auto& state = statement_.states[at(meaning->index)];
      if (state.dynamics) {
        return Error{ErrorCode::invalid_model,
                     fmt::format("the state '{}' has two right-hand sides", entry.name),
                     "keep one of them, or write their sum",
                     entry.location,
                     {}};
      }
      auto f = scope_.expression(*entry.expression);
      if (!f) return with_context(f.error(), fmt::format("in [dynamics] {}", entry.name));
      state.dynamics = *f;
      state.dynamics_location = entry.expression->location;
      return std::nullopt;
    });
  }

  MaybeError mechanics() {
    auto stated = mechanics_of(description_, scope_, statement_);
    if (!stated) return stated.error();
    if (!*stated) return std::nullopt;
    if (!freezing_) return state_mechanics(recognition_, statement_, **stated);
    const auto take = [&](const auto& contacts, const auto& motion) {
      return freeze_contacts(recognition_, statement_, contacts, motion, *freezing_);
    };
    return state_mechanics(recognition_, statement_, **stated, take);
  }

  /// Finite elements and optimal control take the right-hand side as it is written.
  MaybeError written_friction() {
    if (!freezing_ && quantities_ == nullptr) state_written_friction(recognition_, statement_);
    return std::nullopt;
  }

  MaybeError freeze() {
    if (freezing_) freeze_rates(statement_, *freezing_);
    return std::nullopt;
  }

  MaybeError modes() {
    if (auto error = state_modes(description_, scope_, statement_)) return error;
    // Regions of modes of which some could not be read cover what they cover.
    return scope_.has_mistakes() ? std::nullopt : add_modes(recognition_, statement_);
  }

  MaybeError outputs() {
    recognition_.take_whole_parts_of_all(true);
    auto error = take_each(description_.outputs, [&](const NamedExpression& entry) -> MaybeError {
      const auto* name = std::get_if<expression::Name>(&entry.expression->value);
      if (name != nullptr && name->name == entry.name) {
        const Meaning* meaning = scope_.names().find(entry.name);
        if (meaning == nullptr || meaning->kind == NameKind::output) return nothing_to_record(entry, scope_.names());
      }
      auto output = scope_.expression(*entry.expression);
      if (!output) return with_context(output.error(), fmt::format("in [outputs] {}", entry.name));
      statement_.outputs.push_back({entry.name, *output});
      return std::nullopt;
    });
    recognition_.take_whole_parts_of_all(false);
    return error;
  }

  MaybeError quantities() {
    if (quantities_ == nullptr) return std::nullopt;
    for (const auto& entry : quantities_->expressions) {
      if (scope_.translation().is_condition(*entry.expression)) return a_condition(entry);
      auto quantity = scope_.expression(*entry.expression, Reach::outputs_too);
      if (!quantity) return with_context(quantity.error(), fmt::format("in [optimize] {}", entry.name));
      statement_.outputs.push_back({entry.name, *quantity});
    }
    return std::nullopt;
  }

  MaybeError events() {
    return take_each(description_.events, [&](const UserEventDescription& entry) -> MaybeError {
      EventStatement event{
          .name = entry.name, .direction = entry.direction, .action = entry.action, .location = entry.when->location};
      if (scope_.translation().is_condition(*entry.when)) {
        auto condition = scope_.translation().condition(*entry.when);
        if (!condition) return with_context(condition.error(), "in [[events]]");
        event.condition = *condition;
      } else {
        auto value = scope_.expression(*entry.when);
        if (!value) return with_context(value.error(), "in [[events]]");
        event.expression = *value;
      }
      statement_.events.push_back(std::move(event));
      return std::nullopt;
    });
  }

  MaybeError jumps() { return state_jumps(description_, scope_, statement_); }

  MaybeError inputs() {
    auto error = take_each(description_.sampled_inputs, [&](const auto& entry) { return take_samples(entry); });
    if (error) return error;
    return take_each(description_.inputs, [&](const auto& entry) { return take_input(entry); });
  }

  MaybeError take_samples(const SampledInput& entry) {
    const auto* meaning = control_named(entry.name);
    if (meaning == nullptr) return no_such_control(entry.name, entry.location, scope_.names());
    if (set_values_.contains(entry.name)) return std::nullopt;  // a constant from --set replaces it
    if (freezing_) return quantities_ == nullptr ? MaybeError(moving_input(entry.name, entry.location)) : std::nullopt;
    if (const auto mistake = find_mistake(entry.times, entry.values)) {
      return Error{ErrorCode::invalid_model,
                   fmt::format("input '{}': {}", entry.name, mistake->message),
                   mistake->remedy,
                   entry.location,
                   {}};
    }
    auto input = recognition_.lookup(std::make_shared<const CellTable>(step_cells(entry.times, entry.values)),
                                     statement_.time, entry.name);
    if (!input) return with_context(input.error(), fmt::format("in the input of {}", entry.name));
    auto& control = statement_.controls[at(meaning->index)];
    control.input = *input;
    control.input_location = entry.location;
    return std::nullopt;
  }

  MaybeError take_input(const NamedExpression& entry) {
    const auto* meaning = control_named(entry.name);
    if (meaning == nullptr) return no_such_control(entry.name, entry.location, scope_.names());
    auto input = scope_.expression(*entry.expression);
    if (!input) return with_context(input.error(), fmt::format("in the input of {}", entry.name));
    if (set_values_.contains(entry.name)) return std::nullopt;  // a constant from --set replaces it
    if (const auto constant = recognition_.parameter_value(*input); constant && !std::isfinite(*constant)) {
      return Error{ErrorCode::invalid_model,
                   fmt::format("the input of '{}' is {}, not a finite number", entry.name, *constant),
                   "check the expression and the parameters in it",
                   entry.expression->location,
                   {}};
    }
    if (freezing_) {
      const bool constant = recognition_.parameter_value(*input).has_value();
      if (!constant && quantities_ == nullptr) return moving_input(entry.name, entry.expression->location);
      if (!constant) return std::nullopt;  // optimised, it has no input
    }
    auto& control = statement_.controls[at(meaning->index)];
    control.input = *input;
    control.input_location = entry.expression->location;
    return std::nullopt;
  }

  const Meaning* control_named(const std::string& name) const {
    const Meaning* meaning = scope_.names().find(name);
    return meaning != nullptr && meaning->kind == NameKind::control ? meaning : nullptr;
  }

  MaybeError definitions() {
    int i = 0;
    return take_each(description_.definitions, [&](const NamedExpression& entry) -> MaybeError {
      auto error = scope_.resolve_definition(i++);
      return error ? with_context(*error, fmt::format("in [definitions] {}", entry.name)) : error;
    });
  }

  template <class Entries>
  void warn_of_unused(const Entries& entries, const std::string& kind) {
    for (const auto& entry : entries) {
      if (scope_.is_used(entry.name)) continue;
      statement_.warnings.push_back(located(entry.location, fmt::format("{} '{}' is never used", kind, entry.name)));
    }
  }

  void warn_of_unused() {
    warn_of_unused(description_.parameters, "parameter");
    warn_of_unused(description_.controls, "control");
    warn_of_unused(description_.definitions, "definition");
    for (std::size_t i = 0; i < description_.tables.size(); ++i) {
      const auto& table = description_.tables[i];
      if (scope_.is_table_used(i) || scope_.is_used(table.name)) continue;
      statement_.warnings.push_back(located(table.location, fmt::format("table '{}' is never used", table.name)));
    }
  }

  const Description& description_;
  const std::vector<Override> overrides_;
  const Quantities* quantities_;  ///< null: none
  std::optional<FreezingPlan> freezing_;
  Recognition recognition_;
  Statement statement_;
  ModelScope scope_;
  std::map<std::string, double> set_values_;
};

/// CasADi throws on what it cannot do; everything known is checked before, so say what it said.
Error refused_by_casadi(const Description& description, const std::exception& exception) {
  return {ErrorCode::invalid_model,
          fmt::format("CasADi refused the model '{}': {}", description.name, exception.what()),
          "simplify the expression it names",
          {description.file, 0, 0},
          {}};
}

template <class Make>
Expected<System> build_guarded(const Description& description, Make make) {
  try {
    return make();
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& exception) {
    return tl::unexpected(refused_by_casadi(description, exception));
  }
}

}  // namespace

bool stands_still(const Description& description) {
  return !description.contacts.empty() || !description.hysteresis.empty();
}

Expected<System> build(const Description& description, const std::vector<Override>& overrides) {
  auto system = build_with(description, overrides, nullptr);
  if (!system || (!stands_still(description) && system->contacts.empty())) return system;
  system->frozen = std::make_shared<const FrozenSystem>([description, overrides]() -> Expected<System> {
    const Quantities as_written;
    if (!stands_still(description)) return build_with(description, overrides, &as_written);
    FreezingPlan plan{.purpose = FrozenFor::simulation};
    return build_guarded(description, [&] { return Build(description, overrides, nullptr, plan).run(); });
  });
  return system;
}

std::vector<Error> find_mistakes(const Description& description, bool is_whole) {
  try {
    return Build(description, {}, nullptr).mistakes(is_whole);
  } catch (const std::exception& exception) {
    return {refused_by_casadi(description, exception)};
  }
}

Expected<System> build_with(const Description& description, const std::vector<Override>& overrides,
                            const Quantities* quantities) {
  std::optional<FreezingPlan> plan;
  if (quantities != nullptr && quantities->time == TimeForm::frozen) plan.emplace().purpose = FrozenFor::optimisation;
  return build_guarded(description, [&] { return Build(description, overrides, quantities, plan).run(); });
}

}  // namespace saltus::model
