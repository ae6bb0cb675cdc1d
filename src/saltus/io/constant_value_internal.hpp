// Expressions without names: what --set accepts for options.
#pragma once

#include <optional>

#include "saltus/expression/syntax_tree.hpp"

namespace saltus::io {

/// Returns the value of an expression of numbers, pi and smooth functions; nullopt if anything else occurs in it.
[[nodiscard]] std::optional<double> constant_value(const expression::Node& node);

}  // namespace saltus::io
