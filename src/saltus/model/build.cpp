#include "saltus/model/build.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/build_internal.hpp"
#include "saltus/model/discrete_states_internal.hpp"
#include "saltus/model/jumps_internal.hpp"
#include "saltus/model/model_scope_internal.hpp"
#include "saltus/model/modes_internal.hpp"

namespace saltus::model {
namespace {

using expression::NodePtr;
using MaybeError = std::optional<Error>;

/// A description and its overrides on the way to a statement; one step per table.
class Build {
 public:
  Build(const Description& description, const std::vector<Override>& overrides, const Quantities* quantities)
      : description_(description),
        overrides_(overrides),
        quantities_(quantities),
        scope_(description, recognition_, statement_) {}

  [[nodiscard]] Expected<System> run() {
    statement_.name = description_.name;
    statement_.description = description_.description;
    statement_.inclusion = description_.inclusion;
    statement_.time = recognition_.graph.symbol("t", {.kind = VariableKind::time});
    note_all_names();
    using Step = MaybeError (Build::*)();
    constexpr Step steps[] = {&Build::names,  &Build::overrides, &Build::parameters, &Build::controls,
                              &Build::states, &Build::bounds,    &Build::switching,  &Build::dynamics,
                              &Build::modes,  &Build::outputs,   &Build::quantities, &Build::events,
                              &Build::jumps,  &Build::inputs,    &Build::definitions};
    for (const Step step : steps) {
      if (auto error = (this->*step)()) return tl::unexpected(*error);
    }
    warn_of_unused();
    return assemble(recognition_, statement_);
  }

 private:
  MaybeError names() { return scope_.declare_names(); }

  MaybeError overrides() {
    for (const auto& entry : overrides_) {
      const Meaning* meaning = scope_.names().find(entry.name);
      const bool settable =
          meaning != nullptr && (meaning->kind == NameKind::parameter || meaning->kind == NameKind::state ||
                                 meaning->kind == NameKind::control);
      if (!settable) return not_settable(entry, meaning);
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

  Error not_settable(const Override& entry, const Meaning* meaning) const {
    const auto known = scope_.names().of({NameKind::parameter, NameKind::state, NameKind::control});
    const std::string found =
        meaning == nullptr ? "which is not in the model" : fmt::format("which is {}", with_article(meaning->kind));
    return {meaning == nullptr ? ErrorCode::unknown_name : ErrorCode::invalid_option,
            fmt::format("expected the name of a parameter, a state or a control, found '{}', {}", entry.name, found),
            suggest(entry.name, known),
            entry.value ? entry.value->location : SourceLocation{},
            {fmt::format("in --set {}", entry.name)}};
  }

  /// The overriding value of a name, else that of its expression; `absent` without one.
  Expected<double> value_of(const std::string& name, const NodePtr& node, Reach reach, const std::string& what,
                            double absent) {
    if (const auto it = set_values_.find(name); it != set_values_.end()) return it->second;
    if (!node) return absent;
    return scope_.value(*node, reach, what);
  }

  MaybeError parameters() {
    int index = 0;
    for (const auto& entry : description_.parameters) {
      const auto value = value_of(entry.name, entry.expression, Reach::earlier_parameters,
                                  fmt::format("the parameter '{}'", entry.name), 0.0);
      if (!value) return value.error();
      if (!std::isfinite(*value)) {
        return Error{ErrorCode::invalid_model,
                     fmt::format("the parameter '{}' is {}, not a finite number", entry.name, *value),
                     "check its expression and the parameters in it",
                     entry.expression->location,
                     {}};
      }
      // One that an optimisation chooses is a variable like a control: nothing folds at its value.
      const VariableKind kind = quantities_ != nullptr && quantities_->varying_parameters.contains(entry.name)
                                    ? VariableKind::control
                                    : VariableKind::parameter;
      const SXElem symbol = recognition_.graph.symbol(entry.name, {.kind = kind, .index = index++, .value = *value});
      statement_.parameters.push_back({entry.name, symbol, *value});
    }
    return std::nullopt;
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
    return std::nullopt;
  }

  /// Initial values and bounds; they may use parameters, so all names must mean something first.
  MaybeError bounds() {
    for (std::size_t i = 0; i < description_.states.size(); ++i) {
      auto& state = statement_.states[i];
      if (auto error = range(description_.states[i], "state", state.initial, state.bounds)) return error;
      recognition_.graph.set_value(state_variable(state.symbol), state.initial);
    }
    for (std::size_t i = 0; i < description_.controls.size(); ++i) {
      auto& control = statement_.controls[i];
      if (auto error = range(description_.controls[i], "control", control.initial, control.bounds)) return error;
      recognition_.graph.set_value(state_variable(control.symbol), control.initial);
    }
    return std::nullopt;
  }

  int state_variable(const SXElem& symbol) {
    return recognition_.graph.tape()[recognition_.graph.node(symbol)].variable;
  }

  template <class Entry>
  MaybeError range(const Entry& entry, const std::string& kind, double& initial, Bounds& bounds) {
    const std::string what = fmt::format("{} '{}'", kind, entry.name);
    const auto value =
        value_of(entry.name, entry.initial, Reach::everything, fmt::format("the initial value of {}", what), 0.0);
    if (!value) return value.error();
    initial = *value;
    for (const auto& [node, bound, side] :
         {std::tuple{&entry.lower, &bounds.lower, "lower"}, std::tuple{&entry.upper, &bounds.upper, "upper"}}) {
      if (!*node) continue;
      const auto limit = scope_.value(**node, Reach::everything, fmt::format("the {} bound of {}", side, what));
      if (!limit) return limit.error();
      *bound = *limit;
    }
    const SourceLocation& place = entry.initial ? entry.initial->location : entry.location;
    return check_values(what, initial, bounds, place, statement_.warnings);
  }

  MaybeError switching() {
    for (std::size_t i = 0; i < description_.switching.size(); ++i) {
      const auto& entry = description_.switching[i];
      statement_.switching[i].location = entry.location;
      statement_.switching[i].referenced = scope_.is_used(entry.name);
      if (auto error = scope_.resolve_switching(static_cast<int>(i))) {
        return with_context(*error, fmt::format("in [switching] {}", entry.name));
      }
    }
    return std::nullopt;
  }

  MaybeError dynamics() {
    for (const auto& entry : description_.dynamics) {
      const Meaning* meaning = scope_.names().find(entry.name);
      if (meaning == nullptr || meaning->kind != NameKind::state) return no_such_state(entry, meaning);
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
    }
    return std::nullopt;
  }

  MaybeError modes() {
    if (auto error = state_modes(description_, scope_, statement_)) return error;
    return add_modes(recognition_, statement_);
  }

  Error no_such_state(const NamedExpression& entry, const Meaning* meaning) const {
    const std::string found = meaning == nullptr ? "" : fmt::format(", which is {}", with_article(meaning->kind));
    return {ErrorCode::unknown_name,
            fmt::format("expected the name of a state, found '{}'{}", entry.name, found),
            suggest(entry.name, scope_.names().of({NameKind::state})),
            entry.location,
            {"in [dynamics]"}};
  }

  MaybeError outputs() {
    for (const auto& entry : description_.outputs) {
      auto output = scope_.expression(*entry.expression);
      if (!output) return with_context(output.error(), fmt::format("in [outputs] {}", entry.name));
      statement_.outputs.push_back({entry.name, *output});
    }
    return std::nullopt;
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

  static Error a_condition(const NamedExpression& entry) {
    return {ErrorCode::invalid_model,
            fmt::format("expected a number, found the condition '{}'", expression::to_text(*entry.expression)),
            "if(condition, 1, 0) makes a number of it",
            entry.expression->location,
            {fmt::format("in [optimize] {}", entry.name)}};
  }

  MaybeError events() {
    for (const auto& entry : description_.events) {
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
    }
    return std::nullopt;
  }

  MaybeError jumps() { return state_jumps(description_, scope_, statement_); }

  MaybeError inputs() {
    for (const auto& entry : description_.sampled_inputs) {
      const auto* meaning = control_named(entry.name);
      if (meaning == nullptr) return no_such_control(entry.name, entry.location);
      if (set_values_.contains(entry.name)) continue;  // a constant from --set replaces it
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
    }
    for (const auto& entry : description_.inputs) {
      const auto* meaning = control_named(entry.name);
      if (meaning == nullptr) return no_such_control(entry.name, entry.location);
      auto input = scope_.expression(*entry.expression);
      if (!input) return with_context(input.error(), fmt::format("in the input of {}", entry.name));
      if (set_values_.contains(entry.name)) continue;  // a constant from --set replaces it
      if (const auto constant = recognition_.parameter_value(*input); constant && !std::isfinite(*constant)) {
        return Error{ErrorCode::invalid_model,
                     fmt::format("the input of '{}' is {}, not a finite number", entry.name, *constant),
                     "check the expression and the parameters in it",
                     entry.expression->location,
                     {}};
      }
      auto& control = statement_.controls[at(meaning->index)];
      control.input = *input;
      control.input_location = entry.expression->location;
    }
    return std::nullopt;
  }

  const Meaning* control_named(const std::string& name) const {
    const Meaning* meaning = scope_.names().find(name);
    return meaning != nullptr && meaning->kind == NameKind::control ? meaning : nullptr;
  }

  Error no_such_control(const std::string& name, const SourceLocation& location) const {
    const auto known = scope_.names().of({NameKind::control});
    return {ErrorCode::unknown_name,
            fmt::format("expected the name of a control, found '{}'", name),
            known.empty() ? "the model has no controls: declare it in [controls]" : suggest(name, known),
            location,
            {}};
  }

  MaybeError definitions() {
    for (std::size_t i = 0; i < description_.definitions.size(); ++i) {
      if (auto error = scope_.resolve_definition(static_cast<int>(i))) {
        return with_context(*error, fmt::format("in [definitions] {}", description_.definitions[i].name));
      }
    }
    return std::nullopt;
  }

  void note_all_names() {
    for (const auto* table : {&description_.parameters, &description_.definitions, &description_.switching,
                              &description_.dynamics, &description_.outputs, &description_.inputs}) {
      for (const auto& entry : *table) scope_.note_names(entry.expression);
    }
    if (quantities_ != nullptr) {
      for (const auto& entry : quantities_->expressions) scope_.note_names(entry.expression);
    }
    for (const auto& state : description_.states) {
      for (const auto* node : {&state.initial, &state.lower, &state.upper}) scope_.note_names(*node);
    }
    for (const auto& control : description_.controls) {
      for (const auto* node : {&control.initial, &control.lower, &control.upper}) scope_.note_names(*node);
    }
    for (const auto& event : description_.events) scope_.note_names(event.when);
    for (const auto& mode : description_.modes) {
      for (const auto* node : {&mode.when, &mode.indicator}) scope_.note_names(*node);
      for (const auto& entry : mode.dynamics) scope_.note_names(entry.expression);
    }
    for (const auto& jump : description_.jumps) {
      for (const auto* node : {&jump.when, &jump.every, &jump.priority, &jump.delay}) scope_.note_names(*node);
      for (const auto& time : jump.at) scope_.note_names(time);
      for (const auto& entry : jump.set) scope_.note_names(entry.expression);
    }
    if (description_.optimize) note_names_of(*description_.optimize);
  }

  void note_names_of(const OcpDescription& problem) {
    const auto note = [&](const expression::NodePtr& node) {
      if (node) scope_.note_names(node);
    };
    const auto note_all = [&](const std::vector<expression::NodePtr>& nodes) {
      for (const auto& node : nodes) note(node);
    };
    note_all({problem.from, problem.horizon.value, problem.horizon.lower, problem.horizon.upper, problem.running_cost,
              problem.terminal_cost, problem.time_weight});
    for (const auto* constraints : {&problem.path_constraints, &problem.terminal_constraints}) {
      for (const auto& constraint : *constraints) {
        note_all(constraint.sides);
        note(constraint.penalty);
      }
    }
    for (const auto& pair : problem.path_complementarities) note_all({pair.first, pair.second});
    for (const auto& term : problem.least_squares) {
      note_all(term.of);
      note_all(term.reference);
      for (const auto& row : term.weight) note_all(row);
    }
    for (const auto& guess : problem.guess) note(guess.expression);
    for (const auto& parameter : description_.free_parameters) note_all({parameter.lower, parameter.upper});
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
      if (scope_.is_table_used(i)) continue;
      statement_.warnings.push_back(located(table.location, fmt::format("table '{}' is never used", table.name)));
    }
  }

  const Description& description_;
  const std::vector<Override>& overrides_;
  const Quantities* quantities_;  ///< null: none
  Recognition recognition_;
  Statement statement_;
  ModelScope scope_;
  std::map<std::string, double> set_values_;
};

}  // namespace

Expected<System> build(const Description& description, const std::vector<Override>& overrides) {
  return build_with(description, overrides, nullptr);
}

Expected<System> build_with(const Description& description, const std::vector<Override>& overrides,
                            const Quantities* quantities) {
  try {
    return Build(description, overrides, quantities).run();
  } catch (const std::exception& exception) {
    // CasADi throws on what it cannot do; everything known is checked before, so say what it said.
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("CasADi refused the model '{}': {}", description.name, exception.what()),
                                "simplify the expression it names",
                                {description.file, 0, 0},
                                {}});
  }
}

}  // namespace saltus::model
