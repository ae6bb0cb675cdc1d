// Parts of the reader of [optimize].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/io/toml/toml_reader_internal.hpp"
#include "saltus/model/ocp_description.hpp"

namespace saltus::io {

/// Reads ["q <= 3", "-1 <= v <= 2", { constraint = "v == 0", penalty = 1e3, norm = "l1" }].
[[nodiscard]] std::vector<model::ConstraintDescription> read_constraints(TomlReader& reader, const TomlEntry& entry);

/// Reads one of [[optimize.least_squares]].
[[nodiscard]] model::LeastSquaresDescription read_least_squares(TomlReader& reader, const TomlValue& value);

/// Reads a key of [optimize], which the model has.
void read_optimize_key(TomlReader& reader, const TomlEntry& entry, ModelFile& model);

/// Checks that what is free has two bounds, and its initial value is within; only numbers are compared, expressions
/// later.
/// @param what  "the horizon", "'k'"
void check_free(TomlReader& reader, const std::string& what, const expression::NodePtr& initial,
                const expression::NodePtr& lower, const expression::NodePtr& upper, const SourceLocation& location);

/// Changes an option or an expression of [optimize].
/// @param key  "optimize.elements", "optimize.horizon.lower"
[[nodiscard]] Expected<void> set_optimize(ModelFile& model, std::string_view key, std::string_view value);

/// Changes an option and notes that it was given at `location`.
[[nodiscard]] Expected<void> set_optimize_option(ModelFile& model, std::string_view key, std::string_view value,
                                                 const SourceLocation& location);

}  // namespace saltus::io
