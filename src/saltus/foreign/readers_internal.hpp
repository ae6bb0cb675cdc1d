// One reader per format; `parse` knows which.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/foreign/parse.hpp"
#include "saltus/foreign/statement.hpp"

namespace saltus::foreign {

[[nodiscard]] Expected<Statement> parse_nl(std::string_view text, const std::string& file, const Names& names);
/// Reads NOSBENCH and mpecopt's MacMPEC.
[[nodiscard]] Expected<Statement> parse_json(const std::string& text, const std::string& file);

}  // namespace saltus::foreign
