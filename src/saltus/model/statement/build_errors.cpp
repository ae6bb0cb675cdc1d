#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/build_errors_internal.hpp"

namespace saltus::model {

Error not_settable(const Override& entry, const Meaning* meaning, const NameTable& names) {
  const auto known = names.of({NameKind::parameter, NameKind::state, NameKind::control, NameKind::hysteresis});
  const std::string found =
      meaning == nullptr ? "which is not in the model" : fmt::format("which is {}", with_article(meaning->kind));
  // Tables of sweeps call a start "x(0)".
  const auto name = entry.name.substr(0, entry.name.ends_with("(0)") ? entry.name.size() - 3 : entry.name.size());
  return {meaning == nullptr ? ErrorCode::unknown_name : ErrorCode::invalid_option,
          fmt::format("expected the name of a parameter, a state or a control, found '{}', {}", entry.name, found),
          suggest(name, known),
          {entry.value ? entry.value->location.file : std::string(), 0, 0},
          {fmt::format("in --set {}", entry.name)}};
}

Error no_such_state(const NamedExpression& entry, const Meaning* meaning, const NameTable& names) {
  const std::string found = meaning == nullptr ? "" : fmt::format(", which is {}", with_article(meaning->kind));
  return {ErrorCode::unknown_name,
          fmt::format("expected the name of a state, found '{}'{}", entry.name, found),
          suggest(entry.name, names.of({NameKind::state})),
          entry.location,
          {"in [dynamics]"}};
}

Error nothing_to_record(const NamedExpression& entry, const NameTable& names) {
  return {ErrorCode::unknown_name,
          fmt::format("there is no definition '{}' to record", entry.name),
          suggest(entry.name, names.of({NameKind::definition, NameKind::switching})),
          entry.expression->location,
          {"in [outputs]"}};
}

Error a_condition(const NamedExpression& entry) {
  return {ErrorCode::invalid_model,
          fmt::format("expected a number, found the condition '{}'", expression::to_text(*entry.expression)),
          "if(condition, 1, 0) makes a number of it",
          entry.expression->location,
          {fmt::format("in [optimize] {}", entry.name)}};
}

Error moving_input(const std::string& name, const SourceLocation& location) {
  return {ErrorCode::not_available,
          fmt::format("the input of '{}' is not constant: time-freezing does not cover that", name),
          "simulate with method = \"event\", or write the function of t into [dynamics]",
          location,
          {}};
}

Error no_such_control(const std::string& name, const SourceLocation& location, const NameTable& names) {
  const auto known = names.of({NameKind::control});
  return {ErrorCode::unknown_name,
          fmt::format("expected the name of a control, found '{}'", name),
          known.empty() ? "the model has no controls: declare it in [controls]" : suggest(name, known),
          location,
          {}};
}

}  // namespace saltus::model
