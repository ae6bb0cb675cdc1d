// Who declared which name: one name, one meaning across all tables.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::model {

enum class NameKind {
  parameter,
  state,
  control,
  definition,
  switching,
  output,
  event,
  jump,
  table,
  hysteresis,
  contact
};

/// Returns "a parameter", "a state" and the like.
[[nodiscard]] std::string with_article(NameKind kind);

struct Meaning {
  NameKind kind = NameKind::parameter;
  int index = 0;  ///< within its table
  SourceLocation location;
};

/// The name of the state that is the physical time of contacts and hysteresis where that stands still: no user's name
/// has a point in it.
inline constexpr const char* clock_name = "frozen.clock";

class NameTable {
 public:
  /// Refuses names that are reserved, not made of letters, digits and underscores, or taken. Events, jumps and contacts
  /// may be called like a function (a contact "floor"): they occur in no expression.
  [[nodiscard]] std::optional<Error> declare(const std::string& name, const Meaning& meaning);
  [[nodiscard]] const Meaning* find(const std::string& name) const;
  /// Returns names of these kinds, in alphabetical order.
  [[nodiscard]] std::vector<std::string> of(const std::vector<NameKind>& kinds) const;

 private:
  std::map<std::string, Meaning> meanings_;
};

}  // namespace saltus::model
