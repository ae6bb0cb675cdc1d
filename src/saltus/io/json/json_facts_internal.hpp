// What a result says of its computation, as JSON.
#pragma once

#include <string>

#include "saltus/io/json/json_document_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::io {

[[nodiscard]] Json model_json(const result::ModelRecord& model);
[[nodiscard]] Json options_json(const result::OptionRecord& options);

/// Returns the sha256 of model, command, method, status, end state and options: what nobody may edit in a stored
/// result. The same for equal runs.
[[nodiscard]] std::string record_sha256(const result::Result& result);

}  // namespace saltus::io
