// The JSON schema of model files, for editors.
#pragma once

#include <string>

namespace saltus::io {

/// Returns a schema of draft 2020-12: every table and key of a model file with its type and meaning; keys of options
/// from the tables of the pipeline. What a schema cannot say (names, expressions) is for `saltus check`.
[[nodiscard]] std::string model_schema();

}  // namespace saltus::io
