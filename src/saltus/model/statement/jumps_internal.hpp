// [[jumps]]: from the description to the statement, and from there into the system.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

class ModelScope;

/// Resolves the jumps of a description and appends them to the statement.
[[nodiscard]] std::optional<Error> state_jumps(const Description& description, ModelScope& scope, Statement& statement);

/// Returns a stated jump in the form of a System.
/// @param position  from 1, for the default name
/// @return the jump, or an error: a set that is empty or assigns twice, times that do not ascend, a negative delay
[[nodiscard]] Expected<Jump> jump_of(Recognition& recognition, const JumpStatement& stated, int position,
                                     std::vector<std::string>& warnings);

}  // namespace saltus::model
