// JSON as text.
#pragma once

#include <string>

#include "saltus/io/json_reader_internal.hpp"

namespace saltus::io {

/// One name, one row of a table, one event field per line: small to store and still to be read by people.
[[nodiscard]] std::string laid_out(const Json& json);

}  // namespace saltus::io
