// Which values options take, as a JSON schema.
#pragma once

#include "saltus/io/json/json_reader_internal.hpp"
#include "saltus/pipeline/options/option_kind.hpp"

namespace saltus::io {

/// Returns the schema of the values that an option takes.
[[nodiscard]] Json option_schema(const pipeline::OptionKind& kind);

}  // namespace saltus::io
