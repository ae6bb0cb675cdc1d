// Works out the expressions behind names: each once, whatever they need first, cycles refused.
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {
namespace {

/// Names are worked out where they are met, which keeps the functions of a model in the order in which it is read, by
/// recursion. Longer chains are worked out from their far end: the call stack must not depend on the model.
constexpr std::size_t longest_recursion = 32;

}  // namespace

const NamedExpression& ModelScope::entry(const Meaning& meaning) const {
  const auto index = static_cast<std::size_t>(meaning.index);
  return meaning.kind == NameKind::switching ? description_.switching[index] : description_.definitions[index];
}

bool ModelScope::is_worked_out(const Meaning& meaning) const {
  if (meaning.kind == NameKind::switching) return switching_.contains(meaning.index);
  return definitions_.contains(meaning.index) || conditions_.contains(meaning.index);
}

std::optional<Error> ModelScope::enter(const std::string& name, const SourceLocation& location) {
  const auto first = std::find(open_.begin(), open_.end(), name);
  if (first == open_.end()) {
    open_.push_back(name);
    return std::nullopt;
  }
  std::string cycle;
  for (auto it = first; it != open_.end(); ++it) cycle += *it + " -> ";
  return Error{ErrorCode::invalid_model,
               fmt::format("'{}' is defined by itself: {}{}", name, cycle, name),
               "break the cycle; a quantity that feeds back on itself is a state",
               location,
               {}};
}

std::optional<Error> ModelScope::work_out(const Meaning& meaning, const SourceLocation& location) {
  if (auto error = enter(entry(meaning).name, location)) return error;
  auto error = open_.size() > longest_recursion ? work_out_needs(meaning) : std::nullopt;
  if (!error) error = translate(meaning);
  open_.pop_back();
  if (error) give_up(entry(meaning).name);
  return error;
}

std::optional<Error> ModelScope::work_out_needs(const Meaning& meaning) {
  struct Link {
    Meaning meaning;
    std::vector<std::string> needs;
    std::size_t next = 0;
  };
  const auto link = [&](const Meaning& of) { return Link{of, saltus::expression::names_in(*entry(of).expression)}; };
  // A name that is open is left to the translation of the one that needs it, which finds the cycle and its place.
  const auto next_need = [&](Link& of) -> const Meaning* {
    while (of.next < of.needs.size()) {
      const std::string& name = of.needs[of.next++];
      const Meaning* found = names_.find(name);
      const bool has_expression =
          found != nullptr && (found->kind == NameKind::definition || found->kind == NameKind::switching);
      if (has_expression && !is_worked_out(*found) && !contains(open_, name)) {
        return found;
      }
    }
    return nullptr;
  };

  const std::size_t open_before = open_.size();
  std::optional<Error> error;
  std::vector<Link> chain = {link(meaning)};
  while (!error) {
    if (const Meaning* need = next_need(chain.back())) {
      open_.push_back(entry(*need).name);
      chain.push_back(link(*need));
    } else if (chain.size() > 1) {
      error = translate(chain.back().meaning);
      open_.pop_back();
      chain.pop_back();
    } else {
      break;
    }
  }
  open_.resize(open_before);
  return error;
}

std::optional<Error> ModelScope::translate(const Meaning& meaning) {
  if (meaning.kind == NameKind::switching) return declare_switching(meaning.index);
  const NamedExpression& stated = entry(meaning);
  if (is_condition(stated.name)) {
    const auto condition = translation_.condition(*stated.expression);
    if (!condition) return condition.error();
    conditions_.emplace(meaning.index, *condition);
    return std::nullopt;
  }
  const auto number = translation_.number(*stated.expression);
  if (!number) return number.error();
  definitions_.emplace(meaning.index, *number);
  return std::nullopt;
}

std::optional<Error> ModelScope::declare_switching(int index) {
  const NamedExpression& stated = description_.switching[at(index)];
  auto psi = expression(*stated.expression);
  if (!psi) return psi.error();
  auto declared = recognition_.declare(stated.name, *psi);
  if (!declared) {
    declared.error().location = stated.expression->location;
    return declared.error();
  }
  switching_.emplace(index, *psi);
  statement_.switching[at(index)].declared = *declared;
  return std::nullopt;
}

std::optional<Error> ModelScope::resolve_switching(int index) {
  const Meaning meaning{NameKind::switching, index, {}};
  if (is_worked_out(meaning) || is_given_up(entry(meaning).name)) return std::nullopt;
  return work_out(meaning, entry(meaning).location);
}

std::optional<Error> ModelScope::resolve_definition(int index) {
  const Meaning meaning{NameKind::definition, index, {}};
  if (is_worked_out(meaning) || is_given_up(entry(meaning).name)) return std::nullopt;
  return work_out(meaning, entry(meaning).location);
}

}  // namespace saltus::model
