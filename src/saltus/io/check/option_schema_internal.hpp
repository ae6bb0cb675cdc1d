// What the table of options says in words, as a JSON schema.
#pragma once

#include <string_view>

#include "saltus/io/json/json_reader_internal.hpp"

namespace saltus::io {

/// Returns the schema of the values that the table of options expects: "a finite number > 0", "auto, on, off",
/// "none, or a number > 0"; an empty one, which allows everything, for other words.
[[nodiscard]] Json option_schema(std::string_view expects);

}  // namespace saltus::io
