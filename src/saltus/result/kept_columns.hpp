// Results whose rows have some of the columns only.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns whether all of a name fits a pattern, in which * stands for any letters or none.
[[nodiscard]] bool fits(std::string_view pattern, std::string_view name);
/// Returns the names that are meant by names and patterns, as numbers in `all`, ascending. A pattern that is a name
/// means only that: names of switching functions have stars.
/// @return or the first one that means nothing
[[nodiscard]] tl::expected<std::vector<std::size_t>, std::string> numbers_of(const std::vector<std::string>& patterns,
                                                                             const std::vector<std::string>& all);

/// Returns names of the columns that rows have: of Trajectory::x, and of alpha and mode.
[[nodiscard]] std::vector<std::string> states_in_rows(const Result& result);
[[nodiscard]] std::vector<std::string> functions_in_rows(const Result& result);
/// Returns where a state, by its number, stands in the rows; nullopt if it does not.
[[nodiscard]] std::optional<std::size_t> column_of_state(const Result& result, std::size_t state);

/// Leaves those columns of a trajectory that has all.
void keep_columns(const KeptColumns& kept, Trajectory& trajectory);

/// Returns the result as if the model had only what its rows have: for pictures, where everything belongs to a column.
/// End states, events and their alternatives have lost the rest, and so have surfaces in other states.
[[nodiscard]] Result as_in_rows(const Result& result);

}  // namespace saltus::result
