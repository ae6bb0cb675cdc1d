// Places and errors of --set.
#pragma once

#include <string>
#include <string_view>

#include "saltus/base/error.hpp"
#include "saltus/io/toml/toml_model.hpp"

namespace saltus::io {

/// Returns "--set KEY" as the place of an error.
[[nodiscard]] SourceLocation place_of_setting(std::string_view key);

/// Returns an error of --set KEY=VALUE.
[[nodiscard]] tl::unexpected<Error> refused_setting(std::string_view key, ErrorCode code, std::string message,
                                                    std::string remedy);

/// Takes what a control is given away, for something else.
void withdraw_input(model::Description& description, std::string_view name);

/// Returns whether the value of a setting is a table, as in { points = 11 }.
[[nodiscard]] bool is_table_text(std::string_view value);

/// Reads a table behind --set: what is written there replaces what the model has, and the rest stays. Errors are those
/// of the same table in a file.
/// @param key  below [simulate] or [time_freezing], or of [optimize], which the model has (read_optimize_key)
[[nodiscard]] Expected<void> set_table(ModelFile& model, std::string_view key, std::string_view value);

}  // namespace saltus::io
