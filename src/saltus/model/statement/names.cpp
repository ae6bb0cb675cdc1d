#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/enum_names.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/names_internal.hpp"

namespace saltus::model {

namespace {

constexpr EnumNames<NameKind::contact> kinds_with_article("a parameter", "a state", "a control", "a definition",
                                                          "a switching function", "an output", "an event", "a jump",
                                                          "a table", "a hysteresis", "a contact");

/// Names that no expression has: functions are written as they are, whatever is called like one of them.
bool is_label(NameKind kind) { return kind == NameKind::event || kind == NameKind::jump || kind == NameKind::contact; }

bool names_function(const std::string& name) {
  const auto& known = expression::functions();
  return std::any_of(known.begin(), known.end(), [&](const auto& function) { return function.name == name; });
}

}  // namespace

std::string with_article(NameKind kind) { return std::string(kinds_with_article(kind)); }

std::optional<Error> NameTable::declare(const std::string& name, const Meaning& meaning) {
  if (expression::is_reserved(name) && !(is_label(meaning.kind) && names_function(name))) {
    const char* remedy =
        is_label(meaning.kind)
            ? "t, pi, otherwise, and, or, not have their fixed meaning; choose another name"
            : "t, pi, otherwise, and, or, not and the names of functions have their fixed meaning; choose another name";
    return Error{ErrorCode::invalid_model,
                 fmt::format("'{}' is reserved and cannot name {}", name, with_article(meaning.kind)),
                 remedy,
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
    if (contains(kinds, meaning.kind)) names.push_back(name);
  }
  return names;
}

}  // namespace saltus::model
