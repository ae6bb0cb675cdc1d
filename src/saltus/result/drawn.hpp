// Results as pictures show them.
#pragma once

#include <optional>

#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns what pictures show of a result and its branches; nullopt if that is the result itself.
///
/// Its model has only what its rows have (as_in_rows). Every event between them has two rows, also where none were
/// asked for at events: jumps are seen. Such a row has the states, modes and selections of the event. Other columns are
/// not a number there, unless the rows on both sides have one value.
[[nodiscard]] std::optional<Result> as_drawn(const Result& result);

}  // namespace saltus::result
