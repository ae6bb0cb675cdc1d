// MpccResult -> JSON (format saltus-mpcc/1), and the start in one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/mpcc_result.hpp"

namespace saltus::io {

/// Writes numbers as shortest round trip, non-finite ones as null.
[[nodiscard]] std::string to_json(const result::MpccResult& result);

/// Reads `x` of a stored result. Fails for other formats, and where a value is not finite.
[[nodiscard]] Expected<std::vector<double>> read_mpcc_start(const std::filesystem::path& file);

}  // namespace saltus::io
