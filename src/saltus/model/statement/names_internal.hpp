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

/// The name of the physical time of contacts and hysteresis, for which other methods make a state.
inline constexpr const char* clock_name = "clock";

class NameTable {
 public:
  /// Keeps clock_name for what has a clock of its own; refuses it of what is declared, before or behind.
  /// @param beside   whose clock it is, for the error: "[[contacts]]"
  /// @param context  of the error
  [[nodiscard]] std::optional<Error> reserve_clock(const std::string& beside, std::vector<std::string> context = {});
  /// Refuses names that are reserved, not made of letters, digits and underscores, or taken.
  [[nodiscard]] std::optional<Error> declare(const std::string& name, const Meaning& meaning);
  [[nodiscard]] const Meaning* find(const std::string& name) const;
  /// Returns names of these kinds, in alphabetical order.
  [[nodiscard]] std::vector<std::string> of(const std::vector<NameKind>& kinds) const;

 private:
  struct Clock {
    std::string beside;
    std::vector<std::string> context;
  };
  [[nodiscard]] Error taken_by_clock(const Meaning& meaning) const;

  std::map<std::string, Meaning> meanings_;
  std::optional<Clock> clock_;
};

}  // namespace saltus::model
