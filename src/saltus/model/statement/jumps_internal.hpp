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

/// Makes what jumps read of values at their instants: comparisons, floor and the like are those of the values there.
/// Surfaces that nothing else knows are not needed for it.
/// @param f, others  nodes of right-hand sides, and of all else that is known in between
/// @return the nodes that are read
[[nodiscard]] Expected<std::vector<int>> put_at_instants(Recognition& recognition, const Statement& statement,
                                                         const std::vector<int>& f, const std::vector<int>& others,
                                                         System& system);

/// Warns of jumps that set one state at one given time, where the later one, without `values`, reads what the state was
/// before both.
void warn_of_lost_values(const Statement& statement, const System& system, std::vector<std::string>& warnings);

}  // namespace saltus::model
