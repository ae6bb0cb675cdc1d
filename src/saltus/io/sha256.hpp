// SHA-256, for the fingerprint of a model file.
#pragma once

#include <string>
#include <string_view>

namespace saltus::io {

/// Returns SHA-256 of some bytes as 64 lower-case hexadecimal digits. Reference: FIPS 180-4.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace saltus::io
