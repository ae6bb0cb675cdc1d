// [[modes]]: the regions of each group, whether they cover everything once, and the right-hand sides they add up to.
#pragma once

#include <optional>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

class ModelScope;

/// Resolves the modes of a description and appends them to the statement, group by group.
[[nodiscard]] std::optional<Error> state_modes(const Description& description, ModelScope& scope, Statement& statement);

/// Says where each mode of a group holds, over the switching functions met so far.
struct Regions {
  TruthDiagram diagram;
  std::vector<Truth> truth;      ///< one per mode
  std::vector<bool> impossible;  ///< modes that no sign pattern which can occur belongs to
};

/// Returns the regions of a group; every sign pattern that can occur belongs to exactly one of them. Patterns that
/// parallel thresholds exclude (x > 2 with x < 1) count neither as uncovered nor as covered twice.
/// @return the regions, or an error at the mode it is about, which lists the patterns by the names of the functions
[[nodiscard]] Expected<Regions> regions_of(Recognition& recognition, const ModeGroupStatement& group);

/// Adds to every state that a mode of some group mentions the sum over the modes of region polynomial times rate.
[[nodiscard]] std::optional<Error> add_modes(Recognition& recognition, Statement& statement);

}  // namespace saltus::model
