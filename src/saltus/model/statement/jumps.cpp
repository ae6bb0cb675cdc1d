#include <cmath>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/preparation.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/recognition/guards_internal.hpp"
#include "saltus/model/statement/jumps_internal.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {
namespace {

Error jump_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {}};
}

bool is_guard(JumpTrigger trigger) {
  return trigger == JumpTrigger::guard_down || trigger == JumpTrigger::guard_up || trigger == JumpTrigger::guard_both;
}

/// One description on its way into the statement.
class JumpTranslation {
 public:
  JumpTranslation(const JumpDescription& jump, ModelScope& scope) : jump_(jump), scope_(scope) {
    stated_.name = jump.name;
    stated_.trigger = jump.trigger;
    stated_.at_start = jump.at_start;
    stated_.persistent = jump.persistent;
    stated_.evaluated = jump.values;
    stated_.location = jump.location;
    stated_.when_location = jump.when ? jump.when->location : jump.location;
    stated_.delay_location = jump.delay ? jump.delay->location : jump.location;
  }

  /// Null: there are mistakes, all of which the scope collects (ModelScope::end_at).
  [[nodiscard]] Expected<std::optional<JumpStatement>> run() {
    auto error = end_at(trigger());
    for (const auto& entry : jump_.set) {
      if (!error) error = end_at(target(entry));
      if (!error) error = end_at(value(entry));
    }
    if (!error) error = end_at(execution());
    if (error) return tl::unexpected(*error);
    if (broken_) return std::nullopt;
    return std::move(stated_);
  }

 private:
  std::optional<Error> end_at(std::optional<Error> error) {
    if (!error) return std::nullopt;
    broken_ = true;
    return scope_.end_at(with_context(std::move(*error), "in [[jumps]]"));
  }

  std::optional<Error> trigger() {
    if (jump_.trigger == JumpTrigger::times) return times();
    if (jump_.when == nullptr) {
      return jump_error(jump_.location, "this jump has no `when`",
                        "write when = \"condition\", or an expression with a direction");
    }
    const std::string text = expression::to_text(*jump_.when);
    const bool condition = scope_.translation().is_condition(*jump_.when);
    if (is_guard(jump_.trigger)) {
      if (condition) {
        return jump_error(jump_.when->location, fmt::format("`direction` with the condition '{}'", text),
                          "remove `direction`: a condition triggers when it becomes true");
      }
      auto guard = scope_.expression(*jump_.when);
      if (!guard) return guard.error();
      stated_.guard = *guard;
      return std::nullopt;
    }
    const auto* name = std::get_if<expression::Name>(&jump_.when->value);
    if (name != nullptr && scope_.is_given_up(name->name)) return jump_error(jump_.when->location, "", "");
    if (!condition) {
      return jump_error(
          jump_.when->location, fmt::format("expected a condition, found the expression '{}'", text),
          fmt::format("add direction = \"down\" (or \"up\", \"both\") for its zeros, or compare it: {} < 0", text));
    }
    auto translated = scope_.translation().condition(*jump_.when);
    if (!translated) return translated.error();
    stated_.condition = *translated;
    return std::nullopt;
  }

  std::optional<Error> times() {
    if (jump_.every) {
      const auto period = scope_.value(*jump_.every, Reach::everything, "the period `every`");
      if (!period) return period.error();
      stated_.every = *period;
      stated_.when_location = jump_.every->location;
    }
    for (const auto& node : jump_.at) {
      const auto time = scope_.value(*node, Reach::everything, "a time in `at`");
      if (!time) return time.error();
      stated_.times.push_back({*time, node->location});
    }
    return std::nullopt;
  }

  std::optional<Error> target(const NamedExpression& entry) const {
    const Meaning* meaning = scope_.names().find(entry.name);
    if (meaning == nullptr || meaning->kind != NameKind::state) return no_such_state(entry, meaning);
    return std::nullopt;
  }

  std::optional<Error> value(const NamedExpression& entry) {
    scope_.recognition().take_whole_parts_of_all(
        true);  // the value at an instant: it does not jump while a solution goes on
    auto taken = scope_.expression(*entry.expression);
    scope_.recognition().take_whole_parts_of_all(false);
    if (!taken) return with_context(taken.error(), fmt::format("in set {}", entry.name));
    if (!broken_) stated_.set.push_back({scope_.names().find(entry.name)->index, *taken, entry.location});
    return std::nullopt;
  }

  std::optional<Error> execution() {
    for (const auto& [node, result] :
         {std::pair{&jump_.priority, &stated_.priority}, std::pair{&jump_.delay, &stated_.delay}}) {
      if (*node == nullptr) continue;
      auto value = scope_.expression(**node);
      if (!value) return value.error();
      *result = *value;
    }
    return std::nullopt;
  }

  [[nodiscard]] Error no_such_state(const NamedExpression& entry, const Meaning* meaning) const {
    const std::string found = meaning == nullptr ? "" : fmt::format(", which is {}", with_article(meaning->kind));
    return {ErrorCode::unknown_name,
            fmt::format("expected the name of a state, found '{}'{}", entry.name, found),
            meaning == nullptr ? suggest(entry.name, scope_.names().of({NameKind::state}))
                               : "a jump changes states only; make it a state with dynamics 0",
            entry.location,
            {"in set"}};
  }

  const JumpDescription& jump_;
  ModelScope& scope_;
  JumpStatement stated_;
  bool broken_ = false;
};

std::optional<Error> fill_times(const JumpStatement& stated, Jump& jump) {
  if (stated.times.empty() && !(stated.every > 0.0 && std::isfinite(stated.every))) {
    if (stated.every == 0.0 && stated.when_location.line == 0) {
      return jump_error({}, fmt::format("the jump '{}' has no times", jump.name), "give it at least one");
    }
    return jump_error(stated.when_location,
                      fmt::format("the period `every` of the jump '{}' is {}", jump.name, stated.every),
                      "a period is a positive number");
  }
  jump.every = stated.every;
  for (const auto& [time, location] : stated.times) {
    if (!std::isfinite(time)) {
      return jump_error(location, fmt::format("a time of the jump '{}' is {}, not a finite number", jump.name, time),
                        "check the expression and the parameters in it");
    }
    if (!jump.times.empty() && time <= jump.times.back()) {
      return jump_error(
          location,
          fmt::format("the times of the jump '{}' do not ascend: {} after {}", jump.name, time, jump.times.back()),
          "list every time once, in ascending order");
    }
    jump.times.push_back(time);
  }
  return std::nullopt;
}

std::optional<Error> fill_trigger(Recognition& recognition, const JumpStatement& stated, Jump& jump,
                                  std::vector<std::string>& warnings) {
  jump.guards = column({});
  jump.guard_alpha = column({});
  if (stated.trigger == JumpTrigger::times) return fill_times(stated, jump);
  bool constant = false;
  if (stated.guard) {
    const auto node = recognition.graph.add(*stated.guard);
    if (!node) return node.error();
    jump.guards = column({*stated.guard});
    jump.true_at_equality = {false};
    constant = constant_value(recognition.graph.tape(), *node).has_value();
  } else if (stated.condition) {
    Guards guards(recognition);
    const auto truth = guards.truth(*stated.condition);
    if (!truth) return truth.error();
    if (guards.overflowed()) return chain_too_long("the condition of jump " + jump.name);
    guards.fill(jump, *truth);
    // A condition that is always true still triggers at the start with at_start.
    constant = *truth <= 1 && !(*truth == TruthDiagram::constant_true() && stated.at_start);
  }
  if (constant && stated.forbidden.empty()) {
    warnings.push_back(
        located(stated.when_location, fmt::format("jump '{}' never happens: its 'when' is constant", jump.name)));
  }
  return std::nullopt;
}

std::optional<Error> fill_set(Recognition& recognition, const JumpStatement& stated, Jump& jump) {
  if (stated.set.empty()) {
    return jump_error({}, fmt::format("the jump '{}' sets no state", jump.name), "set at least one state");
  }
  std::vector<SXElem> values;
  for (const auto& [state, value, location] : stated.set) {
    if (contains(jump.targets, state)) {
      return jump_error(location, fmt::format("the jump '{}' sets a state twice", jump.name), "set it once");
    }
    if (const auto node = recognition.graph.add(value); !node) return node.error();
    jump.targets.push_back(state);
    values.push_back(value);
  }
  jump.values = column(values);
  return std::nullopt;
}

std::optional<Error> fill_execution(Recognition& recognition, const JumpStatement& stated, Jump& jump) {
  for (const SXElem& e : {stated.priority, stated.delay}) {
    if (const auto node = recognition.graph.add(e); !node) return node.error();
  }
  jump.priority = stated.priority;
  jump.delay = stated.delay;
  const auto delay = recognition.parameter_value(stated.delay);
  if (delay && !(*delay >= 0.0 && std::isfinite(*delay))) {
    return jump_error(stated.delay_location, fmt::format("the delay of the jump '{}' is {}", jump.name, *delay),
                      "a delay is a number that is 0 or positive");
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> state_jumps(const Description& description, ModelScope& scope, Statement& statement) {
  for (const auto& jump : description.jumps) {
    prepares("reading the model", statement.jumps.size(), description.jumps.size());
    auto stated = JumpTranslation(jump, scope).run();
    if (!stated) return stated.error();
    if (*stated) statement.jumps.push_back(std::move(**stated));
  }
  return std::nullopt;
}

Expected<Jump> jump_of(Recognition& recognition, const JumpStatement& stated, int position,
                       std::vector<std::string>& warnings) {
  Jump jump;
  jump.named = stated.name.has_value();
  jump.name = stated.name.value_or(fmt::format("jump{}", position));
  jump.trigger = stated.trigger;
  jump.at_start = stated.at_start;
  jump.persistent = stated.persistent;
  jump.forbidden = stated.forbidden;
  jump.evaluated = stated.evaluated.value_or(JumpValues::at_trigger);
  if (auto error = fill_trigger(recognition, stated, jump, warnings)) return tl::unexpected(*error);
  if (auto error = fill_set(recognition, stated, jump)) return tl::unexpected(*error);
  if (auto error = fill_execution(recognition, stated, jump)) return tl::unexpected(*error);
  return jump;
}

}  // namespace saltus::model
