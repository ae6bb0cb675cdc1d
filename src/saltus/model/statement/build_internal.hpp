// A system with further outputs that are in no table of the description.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Says whether contacts and hysteresis are events, or time stands still there (time_freezing/time_freezing.hpp).
enum class TimeForm { physical, frozen };

/// Holds what a problem about a system asks for beside it.
struct Quantities {
  /// Become outputs behind those of the description; they may speak of outputs, too. The name is for messages.
  std::vector<NamedExpression> expressions;
  std::set<std::string> varying_parameters;
  TimeForm time = TimeForm::physical;
};

/// Returns whether a description has contacts or hysteresis.
[[nodiscard]] bool stands_still(const Description& description);

/// Returns build(), with the quantities; null: none.
[[nodiscard]] Expected<System> build_with(const Description& description, const std::vector<Override>& overrides,
                                          const Quantities* quantities);

}  // namespace saltus::model
