#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/model/recognition/guards_internal.hpp"
#include "saltus/model/recognition/reduction_internal.hpp"
#include "saltus/model/recognition/surface_points_internal.hpp"
#include "saltus/model/recognition/surfaces_internal.hpp"
#include "saltus/model/statement/jumps_internal.hpp"
#include "saltus/model/statement/quantities_internal.hpp"
#include "saltus/model/statement/regions_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {
namespace {

Error nothing_stated() {
  return {ErrorCode::invalid_model,
          "the model has no states",
          "declare at least one in [states], with its right-hand side in [dynamics]; without states there are "
          "[outputs] and [[events]] of t only",
          {},
          {"in [states]"}};
}

/// The steps from a statement to a system, each of which fills some of its fields.
class Assembly {
 public:
  Assembly(Recognition& recognition, const Statement& statement)
      : recognition_(recognition), graph_(recognition.graph), statement_(statement) {}

  [[nodiscard]] Expected<System> run() {
    if (auto error = take_values()) return tl::unexpected(*error);
    if (auto error = take_expressions()) return tl::unexpected(*error);
    if (auto error = take_events()) return tl::unexpected(*error);
    if (auto error = take_jumps()) return tl::unexpected(*error);
    if (auto error = take_regions()) return tl::unexpected(*error);
    keep_used_functions();
    classify_functions();
    if (auto error = take_right_hand_side()) return tl::unexpected(*error);
    if (auto error = interpolate_quantities(graph_, sliding_, system_)) return tl::unexpected(*error);
    take_switching();
    if (auto error = add_regions(graph_, statement_, sliding_, system_)) return tl::unexpected(*error);
    take_cells();
    drop_marks();
    take_columns();
    system_.warnings = statement_.warnings;
    add_switching_warnings();
    take_decisions();
    return std::move(system_);
  }

 private:
  std::optional<Error> take_values() {
    if (statement_.states.empty() && statement_.outputs.empty() && statement_.events.empty()) {
      return nothing_stated();
    }
    system_.name = statement_.name;
    system_.description = statement_.description;
    system_.inclusion = statement_.inclusion;
    for (const auto& parameter : statement_.parameters) {
      system_.parameter_names.push_back(parameter.name);
      system_.parameter_values.push_back(parameter.value);
    }
    for (const auto& state : statement_.states) {
      system_.state_names.push_back(state.name);
      system_.initial_state.push_back(state.initial);
      system_.state_lower.push_back(state.bounds.lower);
      system_.state_upper.push_back(state.bounds.upper);
      if (!state.dynamics) return no_right_hand_side(state.name, state.location);
    }
    for (const auto& group : statement_.mode_groups) {
      system_.mode_groups.push_back({group.name, static_cast<int>(group.modes.size())});
    }
    in_regions_ = moved_by_regions(statement_);
    for (const auto& control : statement_.controls) {
      system_.control_names.push_back(control.name);
      system_.control_initial.push_back(control.initial);
      system_.control_lower.push_back(control.bounds.lower);
      system_.control_upper.push_back(control.bounds.upper);
    }
    return std::nullopt;
  }

  std::optional<Error> take_expressions() {
    std::vector<SXElem> x, u, p, outputs;
    for (const auto& parameter : statement_.parameters) p.push_back(parameter.symbol);
    for (const auto& state : statement_.states) {
      x.push_back(state.symbol);
      if (auto error = take_root(*state.dynamics, f_)) return with_location(*error, state.dynamics_location);
      const auto& rate = graph_.tape()[f_.back()];
      system_.discrete_states.push_back(rate.written == 0 && constant_value(graph_.tape(), f_.back()) == 0.0 &&
                                        !in_regions_[f_.size() - 1]);
    }
    for (const auto* stated : {&statement_.outputs, &statement_.automatic_outputs}) {
      for (const auto& output : *stated) {
        system_.output_names.push_back(output.name);
        outputs.push_back(output.expression);
        if (auto error = take_root(output.expression, others_)) return error;
      }
    }
    system_.contacts = statement_.contacts;
    for (const SXElem& restitution : system_.contacts.restitution.nonzeros()) {
      if (auto error = take_root(restitution, others_)) return error;
    }
    system_.drawing = statement_.drawing;
    system_.t = statement_.time;
    system_.x = column(x);
    system_.p = column(p);
    system_.outputs = column(outputs);
    std::vector<SXElem> input;
    for (const auto& control : statement_.controls) {
      u.push_back(control.symbol);
      input.push_back(control.input ? *control.input : SXElem(control.initial));
      std::vector<int> node;
      if (auto error = take_root(input.back(), node)) return with_location(*error, control.input_location);
      constexpr KindSet forbidden = changing_kinds & ~kind_bit(VariableKind::time) & ~kind_bit(VariableKind::cell);
      if ((graph_.tape()[node.front()].reached & forbidden) != 0) {
        return Error{ErrorCode::invalid_model,
                     fmt::format("the input of '{}' depends on a state or a control", control.name),
                     "inputs are expressions of t and parameters; put a feedback law into [definitions] instead",
                     control.input_location,
                     {}};
      }
      inputs_.push_back(node.front());
    }
    system_.u = column(u);
    system_.input = system_.input_at_instant = column(input);
    return std::nullopt;
  }

  /// Indicators and right-hand sides of modes by `indicator`.
  std::optional<Error> take_regions() {
    for (const auto& [indicator, location] : indicators(statement_)) {
      if (auto error = take_root(indicator, others_)) return with_location(*error, location);
    }
    for (const auto& [state, rate, location] : region_rates(statement_)) {
      if (auto error = take_root(rate, others_)) return with_location(*error, location);
    }
    return std::nullopt;
  }

  std::optional<Error> take_root(const SXElem& expression, std::vector<int>& nodes) {
    const auto node = graph_.add(expression);
    if (!node) return node.error();
    nodes.push_back(*node);
    return std::nullopt;
  }

  std::optional<Error> take_events() {
    int position = 0;
    for (const auto& stated : statement_.events) {
      ++position;
      UserEvent event;
      event.named = stated.name.has_value();
      event.name = stated.name.value_or(fmt::format("event{}", position));
      event.direction = stated.direction;
      event.action = stated.action;
      if (auto error = fill_event(stated, event)) return with_location(*error, stated.location);
      system_.events.push_back(std::move(event));
    }
    return std::nullopt;
  }

  std::optional<Error> fill_event(const EventStatement& stated, UserEvent& event) {
    bool constant = false;
    if (stated.expression) {
      if (auto error = take_root(*stated.expression, others_)) return error;
      event.value = *stated.expression;
      event.guards = column({});
      event.guard_alpha = column({});
      constant = constant_value(graph_.tape(), others_.back()).has_value();
    } else {
      Guards guards(recognition_);
      const auto truth = guards.truth(*stated.condition);
      if (!truth) return truth.error();
      if (guards.overflowed()) return chain_too_long("the condition of event " + event.name);
      guards.fill(event, *truth);
      constant = *truth <= 1;
      for (const SXElem& guard : event.guards.nonzeros()) others_.push_back(graph_.node(guard));
    }
    if (constant) {
      event_warnings_.push_back(
          located(stated.location, fmt::format("event '{}' never happens: its 'when' is constant", event.name)));
    }
    return std::nullopt;
  }

  std::optional<Error> take_jumps() {
    for (const auto& stated : statement_.jumps) {
      auto jump = jump_of(recognition_, stated, static_cast<int>(system_.jumps.size()) + 1, event_warnings_);
      if (!jump) return with_context(with_location(jump.error(), stated.location), "in [[jumps]]");
      for (const SXElem& e : jump->guards.nonzeros()) others_.push_back(graph_.node(e));
      system_.jumps.push_back(std::move(*jump));
    }
    warn_of_lost_values(statement_, system_, event_warnings_);
    auto roots = others_;
    roots.insert(roots.end(), inputs_.begin(), inputs_.end());
    const auto read = put_at_instants(recognition_, statement_, f_, roots, system_);
    if (!read) return read.error();
    at_instants_ = *read;
    return std::nullopt;
  }

  /// Unnamed functions that occur in nothing but definitions nobody uses are dropped.
  void keep_used_functions() {
    const auto& met = recognition_.functions();
    std::vector<int> roots = f_;
    for (const auto* more : {&others_, &at_instants_, &inputs_}) roots.insert(roots.end(), more->begin(), more->end());
    used_ = recognition_.functions_below(roots);
    for (const auto& function : met) {
      if (function.named) roots.push_back(function.psi_node);
    }
    const auto kept = recognition_.functions_below(roots);
    // Inner functions have smaller indices: those of inputs, which are met last, are inside any that compare an input.
    const auto of_inputs = recognition_.functions_below(inputs_);
    new_index_.assign(met.size(), -1);
    for (const bool first : {true, false}) {
      for (std::size_t i = 0; i < met.size(); ++i) {
        if (of_inputs[i] != first || (!met[i].named && !kept[i])) continue;
        new_index_[i] = static_cast<int>(kept_.size());
        kept_.push_back(static_cast<int>(i));
      }
    }
  }

  [[nodiscard]] std::size_t alpha_index(int node) const {
    const int variable = graph_.tape()[node].variable;
    return static_cast<std::size_t>(graph_.tape().variables()[at(variable)].index);
  }

  [[nodiscard]] const MetFunction& met(int index) const { return recognition_.functions()[at(index)]; }

  void classify_functions() {
    targets_ = f_;
    targets_.insert(targets_.end(), others_.begin(), others_.end());
    for (const int index : kept_) {
      if (met(index).discrete) discrete_[met(index).alpha_node] = met(index).alpha_at_zero.value_or(0.5);
      surfaces_.push_back({met(index).psi_node, met(index).alpha_node});
      targets_.push_back(met(index).psi_node);
    }
    classes_ = classify(graph_.tape(), surfaces_, discrete_, targets_);
    mark_equalities();
  }

  /// n == 2 is n >= 2 and n <= 2: on the surface of each the other one decides, so that neither is seen to jump alone.
  void mark_equalities() {
    std::vector<std::size_t> discrete;
    std::vector<int> psi;
    for (std::size_t i = 0; i < classes_.size(); ++i) {
      if (classes_[i].role != SwitchingRole::discrete) continue;
      discrete.push_back(i);
      psi.push_back(surfaces_[i].psi);
    }
    const auto first = first_multiples(graph_.tape(), psi);
    for (std::size_t k = 0; k < first.size(); ++k) {
      if (first[k] == k) continue;
      for (const std::size_t i : {discrete[k], discrete[first[k]]}) {
        classes_[i].jumps = used_[at(kept_[i])];
      }
    }
  }

  std::optional<Error> take_right_hand_side() {
    // Only the alphas of listed surfaces can stay between 0 and 1 where their value matters.
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      if (classes_[i].role == SwitchingRole::listed) sliding_.insert(surfaces_[i].alpha);
    }
    const auto mixed = statement_.inclusion == Inclusion::aizerman_pyatnitskii ? std::set<int>{} : sliding_;
    std::vector<SXElem> as_written, reduced;
    for (std::size_t i = 0; i < f_.size(); ++i) {
      prepares("writing right-hand sides", i, f_.size());
      const auto& state = statement_.states[i];
      as_written.push_back(*state.dynamics);
      if (bends(f_[i])) system_.inclusion_differences.push_back(state.name);
      auto component = interpolate(graph_, f_[i], mixed, "the dynamics of " + state.name);
      if (!component) return with_location(component.error(), state.dynamics_location);
      reduced.push_back(*component);
    }
    for (const auto& [state, rate, location] : region_rates(statement_)) {
      const auto& name = statement_.states[at(state)].name;
      if (bends(graph_.node(rate))) system_.inclusion_differences.push_back(name);
    }
    system_.f_as_written = column(as_written);
    system_.f = column(reduced);
    // What forces in numbers hold is the motion of the reduced right-hand side.
    for (SXElem& acceleration : system_.contacts.acceleration.nonzeros()) {
      const auto motion = interpolate(graph_, graph_.node(acceleration), mixed, "the accelerations of contacts");
      if (!motion) return motion.error();
      acceleration = *motion;
    }
    return std::nullopt;
  }

  bool bends(int node) {
    bool found = false;
    for (const int alpha : nonaffine_alphas(graph_.tape(), node)) {
      if (!sliding_.contains(alpha)) continue;
      system_.multi_affine = false;
      found = found || bends_on_surface(graph_.tape(), {graph_.tape()[alpha].psi, alpha}, discrete_, node);
    }
    return found;
  }

  void take_switching() {
    std::vector<SXElem> alphas;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const MetFunction& function = met(kept_[i]);
      alphas.push_back(function.alpha);
      SwitchingFunction switching{function.name, function.psi, classes_[i].role, function.named, {}};
      switching.alpha_at_zero = function.alpha_at_zero.value_or(0.5);
      for (const int node : graph_.tape().cone(std::span(&function.psi_node, 1), Links::written)) {
        if (graph_.tape()[node].psi >= 0) switching.inner.push_back(new_index_[alpha_index(node)]);
      }
      system_.switching.push_back(std::move(switching));
    }
    system_.alpha = column(alphas);
  }

  /// Those that something needs; switching functions that were dropped may leave some without use.
  void take_cells() {
    std::vector<int> roots = f_;
    for (const auto* more : {&others_, &at_instants_, &inputs_}) roots.insert(roots.end(), more->begin(), more->end());
    for (const int index : kept_) roots.push_back(met(index).psi_node);
    std::set<int> used;
    for (const int node : graph_.tape().cone(roots, Links::through_alpha)) {
      if (graph_.tape()[node].operation == cell_operation) used.insert(node);
    }
    for (const auto& cell : graph_.cells()) {
      if (std::none_of(cell.nodes.begin(), cell.nodes.end(), [&](int node) { return used.contains(node); })) continue;
      system_.cells.push_back({cell.name, casadi::SX(cell.argument), column(cell.symbols), cell.table});
    }
  }

  /// Of how terms were written.
  void drop_marks() {
    std::vector<casadi::SX*> all{&system_.f, &system_.f_as_written, &system_.outputs, &system_.input,
                                 &system_.input_at_instant};
    for (auto& function : system_.switching) all.push_back(&function.psi);
    for (auto& event : system_.events) all.insert(all.end(), {&event.value, &event.guards});
    for (auto& jump : system_.jumps) all.insert(all.end(), {&jump.guards, &jump.values, &jump.priority, &jump.delay});
    for (auto& cell : system_.cells) all.push_back(&cell.argument);
    auto& touching = system_.contacts;
    all.insert(all.end(), {&touching.gap, &touching.velocity, &touching.rows, &touching.responses,
                           &touching.acceleration, &touching.cone, &touching.normal_force, &touching.tangential_force,
                           &touching.friction, &touching.restitution});
    KnownExpressions known;
    for (auto* expressions : all) graph_.drop_marks(*expressions, known);
  }

  void take_decisions() {
    Decisions decisions{.noted = recognition_.decisions(),
                        .discrete = discrete_,
                        .targets = targets_,
                        .mass_pivots = statement_.mass_pivots};
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      decisions.functions.emplace_back(surfaces_[i].psi, met(kept_[i]).name);
      if (classes_[i].role == SwitchingRole::kink) decisions.kinks.push_back(surfaces_[i]);
    }
    system_.decisions = on_tape_of_their_own(graph_.tape(), std::move(decisions));
  }

  void take_columns() {
    for (const auto& stated : statement_.switching) {
      const SharedFunction& function = stated.declared.function;
      const int index = new_index_[at(function.function)];
      system_.columns.push_back({stated.declared.name, index, function.orientation});
    }
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const auto& function = system_.switching[i];
      if (function.named || !classes_[i].jumps) continue;
      system_.columns.push_back({function.name, static_cast<int>(i), +1});
    }
  }

  void add_switching_warnings() {
    for (const auto& stated : statement_.switching) {
      const auto& declared = stated.declared;
      if (!declared.alias_of.empty()) {
        const std::string multiple = declared.function.orientation > 0 ? "" : "a negative multiple of ";
        system_.warnings.push_back(
            located(stated.location, fmt::format("switching function '{}' is {}'{}' under another name", declared.name,
                                                 multiple.empty() ? "a multiple of " : multiple, declared.alias_of)));
      } else if (!stated.referenced && !used_[at(declared.function.function)]) {
        system_.warnings.push_back(
            located(stated.location, fmt::format("switching function '{}' is never used", declared.name)));
      }
    }
    warn_of_late_discrete_states();
    system_.warnings.insert(system_.warnings.end(), event_warnings_.begin(), event_warnings_.end());
  }

  /// Comparisons are made before dynamics are known: in C++ a discrete state is declared as one.
  void warn_of_late_discrete_states() {
    for (const int index : kept_) {
      const int psi = met(index).psi_node;
      if ((graph_.tape()[psi].reached & moving_kinds) != kind_bit(VariableKind::state)) continue;
      const auto variables = moving_variables(graph_.tape(), std::span(&psi, 1));
      const bool still = std::all_of(variables.begin(), variables.end(), [&](int variable) {
        const auto& entry = graph_.tape().variables()[at(variable)];
        if (entry.kind != VariableKind::state) return true;  // of a cell's argument
        return static_cast<bool>(system_.discrete_states[at(entry.index)]);
      });
      if (!still) continue;
      system_.warnings.push_back(fmt::format(
          "switching function '{}' was made of states that never move as of moving ones: give them dynamics 0 without "
          "names (in C++ discrete_state()), so that it is decided as written where it is 0",
          met(index).name));
    }
  }

  Recognition& recognition_;
  SxGraph& graph_;
  const Statement& statement_;
  System system_;
  std::set<int> sliding_;                 ///< alpha nodes of listed functions
  std::vector<bool> in_regions_;          ///< by state: a mode by `indicator` moves it
  std::vector<int> f_, others_, inputs_;  ///< nodes: right-hand sides; outputs, events, guards of jumps; inputs
  std::vector<int> at_instants_;          ///< nodes of what jumps read at their instants: nothing jumps by that
  std::vector<bool> used_;                ///< by met function: something but a named psi needs it
  std::vector<int> kept_, new_index_;     ///< met functions that stay, and the new number of every one
  std::vector<Surface> surfaces_;
  Selections discrete_;       ///< of the discrete functions, where they are 0
  std::vector<int> targets_;  ///< what could jump
  std::vector<SurfaceClass> classes_;
  std::vector<std::string> event_warnings_;
};

}  // namespace

Error no_right_hand_side(const std::string& state, const SourceLocation& location) {
  const std::string remedy = location.line > 0
                                 ? "add {} = \"…\" to [dynamics] or to a mode; a constant state gets 0"
                                 : "call dynamics(\"{}\", …), or name it in a mode; a constant state gets 0";
  return {ErrorCode::invalid_model,
          fmt::format("the state '{}' has no right-hand side", state),
          fmt::format(fmt::runtime(remedy), state),
          location,
          {}};
}

std::string located(const SourceLocation& location, const std::string& text) {
  if (location.line == 0) return text;
  const std::string file = location.file.empty() ? "" : location.file + ":";
  return fmt::format("{}{}: {}", file, location.line, text);
}

std::optional<Error> check_values(const std::string& what, double initial, const Bounds& bounds,
                                  const SourceLocation& location, std::vector<std::string>& warnings) {
  if (!std::isfinite(initial)) {
    return Error{ErrorCode::invalid_model,
                 fmt::format("the initial value of {} is {}, not a finite number", what, initial),
                 "check the expression and the parameters in it",
                 location,
                 {}};
  }
  if (!(bounds.lower <= bounds.upper)) {
    return Error{
        ErrorCode::invalid_model,
        fmt::format("the bounds of {} exclude each other: lower = {}, upper = {}", what, bounds.lower, bounds.upper),
        "lower must not exceed upper",
        location,
        {}};
  }
  if (initial < bounds.lower || initial > bounds.upper) {
    warnings.push_back(located(location, fmt::format("the initial value {} of {} lies outside its bounds [{}, {}]",
                                                     initial, what, bounds.lower, bounds.upper)));
  }
  return std::nullopt;
}

Expected<System> assemble(Recognition& recognition, const Statement& statement) {
  return Assembly(recognition, statement).run();
}

}  // namespace saltus::model
