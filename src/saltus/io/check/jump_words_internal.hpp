// When a jump happens, in words.
#pragma once

#include <string>

#include "saltus/model/description.hpp"

namespace saltus::io {

/// Says when a jump happens: "when y falls below 0", "every 0.5".
[[nodiscard]] std::string when_text(const model::JumpDescription& jump);

}  // namespace saltus::io
