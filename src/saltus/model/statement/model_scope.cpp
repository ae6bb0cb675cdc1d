#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {
namespace {

template <class Entries>
void collect(const Entries& entries, NameKind kind, std::vector<std::pair<std::string, Meaning>>& found) {
  int index = 0;
  for (const auto& entry : entries) found.push_back({entry.name, {kind, index++, entry.location}});
}

/// Tables are called.
void note_calls(const saltus::expression::Node& node, std::set<std::string>& used) {
  if (const auto* unary = std::get_if<saltus::expression::Unary>(&node.value)) note_calls(*unary->operand, used);
  if (const auto* binary = std::get_if<saltus::expression::Binary>(&node.value)) {
    note_calls(*binary->left, used);
    note_calls(*binary->right, used);
  }
  const auto* call = std::get_if<saltus::expression::Call>(&node.value);
  if (call == nullptr) return;
  used.insert(call->function);
  for (const auto& argument : call->arguments) note_calls(*argument, used);
}

}  // namespace

ModelScope::ModelScope(const Description& description, Recognition& recognition, Statement& statement)
    : description_(description), recognition_(recognition), statement_(statement), translation_(recognition, *this) {}

std::optional<Error> ModelScope::declare_names() {
  std::vector<std::pair<std::string, Meaning>> found;
  collect(description_.parameters, NameKind::parameter, found);
  collect(description_.states, NameKind::state, found);
  collect(description_.controls, NameKind::control, found);
  collect(description_.definitions, NameKind::definition, found);
  collect(description_.switching, NameKind::switching, found);
  collect(description_.outputs, NameKind::output, found);
  collect(description_.tables, NameKind::table, found);
  collect(description_.hysteresis, NameKind::hysteresis, found);
  collect(description_.contacts, NameKind::contact, found);
  int position = 0;
  for (const auto& event : description_.events) {
    const std::string name = event.name.value_or(fmt::format("event{}", position + 1));
    found.push_back({name, {NameKind::event, position++, event.location}});
  }
  position = 0;
  for (const auto& jump : description_.jumps) {
    const std::string name = jump.name.value_or(fmt::format("jump{}", position + 1));
    found.push_back({name, {NameKind::jump, position++, jump.location}});
  }
  std::set<std::string> shared;  // once each: a second one clashes
  std::erase_if(found, [&](const auto& entry) {
    return is_shared(entry.first, entry.second) && shared.insert(entry.first).second;
  });
  // The later one of two equal names is the wrong one.
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.second.location.line < b.second.location.line; });
  for (const auto& [name, meaning] : found) {
    auto error = names_.declare(name, meaning);
    if (!error) continue;
    give_up(name);
    if ((error = end_at(std::move(*error)))) return error;
  }
  return std::nullopt;
}

/// An output that records a definition or a switching function under its name, and a jump that is called like a state.
bool ModelScope::is_shared(const std::string& name, const Meaning& meaning) const {
  const auto declares = [&](const auto& entries) {
    return std::any_of(entries.begin(), entries.end(), [&](const auto& entry) { return entry.name == name; });
  };
  if (meaning.kind == NameKind::jump) return declares(description_.states);
  if (meaning.kind != NameKind::output) return false;
  const auto* recorded =
      std::get_if<saltus::expression::Name>(&description_.outputs[at(meaning.index)].expression->value);
  return recorded != nullptr && recorded->name == name &&
         (declares(description_.definitions) || declares(description_.switching));
}

std::optional<Error> ModelScope::end_at(Error error) {
  if (found_ == nullptr) return error;
  if (error.message.empty() || (!is_whole_ && error.code == ErrorCode::unknown_name)) {
    follows_mistake_ = true;
  } else {
    found_->push_back(std::move(error));
  }
  return std::nullopt;
}

Error ModelScope::unknown(const std::string& name, const SourceLocation& location) const {
  std::vector<std::string> known;
  if (reach_ >= Reach::everything) {
    known = names_.of({NameKind::parameter, NameKind::state, NameKind::control, NameKind::definition,
                       NameKind::switching, NameKind::hysteresis});
    known.insert(known.end(), {"t", "pi"});
  } else {
    if (reach_ == Reach::earlier_parameters) {
      for (const auto& parameter : statement_.parameters) known.push_back(parameter.name);
    }
    known.push_back("pi");
  }
  return {ErrorCode::unknown_name, fmt::format("unknown name '{}'", name), suggest(name, known), location, {}};
}

Error ModelScope::out_of_reach(const std::string& name, const Meaning& meaning, const SourceLocation& location) const {
  if (reach_ == Reach::constants) {
    return {ErrorCode::invalid_model,
            fmt::format("expected constants, found '{}', which is {}", name, with_article(meaning.kind)),
            "a value on the command line consists of numbers, pi and functions",
            location,
            {}};
  }
  if (meaning.kind == NameKind::parameter) {
    return {ErrorCode::invalid_model,
            fmt::format("the parameter '{}' is used before it is declared", name),
            "a parameter's expression may use earlier parameters only; change their order",
            location,
            {}};
  }
  return {
      ErrorCode::invalid_model,
      fmt::format("a parameter is a constant and cannot depend on '{}', which is {}", name, with_article(meaning.kind)),
      "use numbers and earlier parameters, or make it a definition",
      location,
      {}};
}

Expected<SXElem> ModelScope::number(const std::string& name, const SourceLocation& location) {
  if (name == "t") {
    if (reach_ >= Reach::everything) return statement_.time;
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                "a constant cannot depend on the time t",
                                "use numbers, pi and functions of them",
                                location,
                                {}});
  }
  if (is_given_up(name)) return tl::unexpected(Error{ErrorCode::invalid_model, "", "", location, {}});
  const Meaning* meaning = names_.find(name);
  if (meaning == nullptr) return tl::unexpected(unknown(name, location));
  const bool known_parameter =
      meaning->kind == NameKind::parameter && meaning->index < static_cast<int>(statement_.parameters.size());
  if (reach_ == Reach::constants || (reach_ == Reach::earlier_parameters && !known_parameter)) {
    return tl::unexpected(out_of_reach(name, *meaning, location));
  }
  return meant(name, *meaning, location);
}

Expected<SXElem> ModelScope::meant(const std::string& name, const Meaning& meaning, const SourceLocation& location) {
  const auto index = static_cast<std::size_t>(meaning.index);
  switch (meaning.kind) {
    case NameKind::parameter:
      return statement_.parameters[index].symbol;
    case NameKind::state:
      return statement_.states[index].symbol;
    case NameKind::hysteresis:  // behind the states
      return statement_.states[description_.states.size() + index].symbol;
    case NameKind::control:
      return statement_.controls[index].symbol;
    case NameKind::definition:
      return definition(meaning.index, location);
    case NameKind::switching:
      if (!switching_.contains(meaning.index)) {
        if (auto error = work_out(meaning, location)) return tl::unexpected(*error);
      }
      return switching_.at(meaning.index);
    case NameKind::output:
      if (reach_ == Reach::outputs_too) return statement_.outputs[index].expression;
      break;
    case NameKind::event:
    case NameKind::jump:
    case NameKind::table:
    case NameKind::contact:
      break;
  }
  if (meaning.kind == NameKind::table) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("'{}' is a table, a function of one argument", name),
                                fmt::format("write {}(t), or another argument", name),
                                location,
                                {}});
  }
  return tl::unexpected(
      Error{ErrorCode::invalid_model,
            fmt::format("'{}' is {} and cannot be used in an expression", name, with_article(meaning.kind)),
            "make it a definition and use that in both places",
            location,
            {}});
}

Expected<std::shared_ptr<const CellTable>> ModelScope::table(const std::string& name) {
  const Meaning* meaning = names_.find(name);
  // The parser knows its name, so it stands in the file, and what is wrong with it is known.
  if (meaning == nullptr) return tl::unexpected(Error{ErrorCode::invalid_model, "", "", {}, {}});
  const auto index = static_cast<std::size_t>(meaning->index);
  if (tables_.size() <= index) tables_.resize(description_.tables.size());
  auto& cells = tables_[index];
  if (cells) return cells;
  const TableDescription& stated = description_.tables[index];
  if (const auto mistake = find_mistake(stated.x, stated.y, stated.kind)) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("table '{}': {}", name, mistake->message),
                                mistake->remedy,
                                stated.location,
                                {}});
  }
  cells = std::make_shared<const CellTable>(table_cells(stated.x, stated.y, stated.kind));
  return cells;
}

Expected<SXElem> ModelScope::definition(int index, const SourceLocation& location) {
  if (const auto known = definitions_.find(index); known != definitions_.end()) return known->second;
  if (auto error = work_out({NameKind::definition, index, {}}, location)) return tl::unexpected(*error);
  return definitions_.at(index);
}

Expected<Condition> ModelScope::condition(const std::string& name, const SourceLocation& location) {
  const Meaning& meaning = *names_.find(name);
  if (reach_ < Reach::everything) return tl::unexpected(out_of_reach(name, meaning, location));
  if (is_given_up(name)) return tl::unexpected(Error{ErrorCode::invalid_model, "", "", location, {}});
  if (const auto known = conditions_.find(meaning.index); known != conditions_.end()) return known->second;
  if (auto error = work_out(meaning, location)) return tl::unexpected(*error);
  return conditions_.at(meaning.index);
}

bool ModelScope::is_condition(const std::string& name) const {
  const Meaning* meaning = names_.find(name);
  // Follows definitions that are mere names of others; a cycle of them is reported as one elsewhere.
  for (std::size_t hops = 0; hops <= description_.definitions.size(); ++hops) {
    if (meaning == nullptr || meaning->kind != NameKind::definition) return false;
    const auto& node = *description_.definitions[at(meaning->index)].expression;
    const auto* other = std::get_if<saltus::expression::Name>(&node.value);
    if (other == nullptr) return translation_.is_condition(node);
    meaning = names_.find(other->name);
  }
  return false;
}

Expected<SXElem> ModelScope::expression(const saltus::expression::Node& node, Reach reach) {
  const Reach before = std::exchange(reach_, reach);
  auto result = translation_.number(node);
  reach_ = before;
  if (!result) return result;
  if (const auto added = recognition_.graph.add(*result); !added) return tl::unexpected(added.error());
  return result;
}

Expected<double> ModelScope::value(const saltus::expression::Node& node, Reach reach, const std::string& what,
                                   const std::optional<ComputedNumber>& computed) {
  const auto translated = expression(node, reach);
  if (!translated) return tl::unexpected(translated.error());
  if (const auto constant = recognition_.parameter_value(*translated)) {
    if (!computed) return *constant;
    const int number = recognition_.graph.node(*translated);
    recognition_.note({.kind = Decision::Kind::value, .node = number, .computed = *computed}, [&] { return what; });
    return *constant;
  }
  return tl::unexpected(Error{ErrorCode::invalid_model,
                              fmt::format("{} must be a constant, found '{}'", what, saltus::expression::to_text(node)),
                              "use numbers and parameters",
                              node.location,
                              {}});
}

void ModelScope::note_names(const saltus::expression::NodePtr& node) {
  if (!node) return;
  for (auto& name : saltus::expression::names_in(*node)) used_.insert(std::move(name));
  note_calls(*node, used_);
}

}  // namespace saltus::model
