// What mass matrices, potentials and gaps may speak of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

/// Holds an expression of positions and parameters, smooth unless it may switch.
struct SmoothOf {
  const std::vector<int>& positions;
  bool and_time = false;
  std::string what;  ///< "the potential"
  SourceLocation location;
  bool may_switch = false;  ///< nobody needs its derivatives
};

/// Refuses an expression (by its node) that switches where it must not, or that depends on anything else.
[[nodiscard]] std::optional<Error> check_smooth(const Recognition& recognition, const Statement& statement, int node,
                                                const SmoothOf& allowed);

}  // namespace saltus::model
