#include <algorithm>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/names_internal.hpp"

namespace saltus::model {

std::string with_article(NameKind kind) {
  switch (kind) {
    case NameKind::parameter:
      return "a parameter";
    case NameKind::state:
      return "a state";
    case NameKind::control:
      return "a control";
    case NameKind::definition:
      return "a definition";
    case NameKind::switching:
      return "a switching function";
    case NameKind::output:
      return "an output";
    case NameKind::event:
      return "an event";
    case NameKind::jump:
      return "a jump";
    case NameKind::table:
      return "a table";
    case NameKind::hysteresis:
      return "a hysteresis";
    case NameKind::contact:
      return "a contact";
  }
  return "";
}

std::optional<Error> NameTable::declare(const std::string& name, const Meaning& meaning) {
  if (expression::is_reserved(name)) {
    return Error{
        ErrorCode::invalid_model,
        fmt::format("'{}' is reserved and cannot name {}", name, with_article(meaning.kind)),
        "t, pi, otherwise, and, or, not and the names of functions have their fixed meaning; choose another name",
        meaning.location,
        {}};
  }
  if (!expression::is_identifier(name)) {
    return Error{ErrorCode::invalid_model,
                 fmt::format("'{}' cannot name {}", name, with_article(meaning.kind)),
                 "names consist of letters, digits and underscores and do not begin with a digit",
                 meaning.location,
                 {}};
  }
  const auto [it, fresh] = meanings_.emplace(name, meaning);
  if (fresh) return std::nullopt;
  const Meaning& first = it->second;
  const std::string where = first.location.line > 0 ? fmt::format(" (line {})", first.location.line) : "";
  return Error{ErrorCode::invalid_model,
               fmt::format("'{}' is already {}{} and cannot be {}, too", name, with_article(first.kind), where,
                           with_article(meaning.kind)),
               "one name has one meaning across all tables; rename one of them",
               meaning.location,
               {}};
}

const Meaning* NameTable::find(const std::string& name) const {
  const auto it = meanings_.find(name);
  return it == meanings_.end() ? nullptr : &it->second;
}

std::vector<std::string> NameTable::of(const std::vector<NameKind>& kinds) const {
  std::vector<std::string> names;
  for (const auto& [name, meaning] : meanings_) {
    if (std::find(kinds.begin(), kinds.end(), meaning.kind) != kinds.end()) names.push_back(name);
  }
  return names;
}

}  // namespace saltus::model
