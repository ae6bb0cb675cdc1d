// Whether two mistakes are one.
#pragma once

#include "saltus/base/error.hpp"

namespace saltus {

/// Returns whether both places are known, and the same.
[[nodiscard]] inline bool same_place(const SourceLocation& a, const SourceLocation& b) {
  return a.line > 0 && a.line == b.line && a.column == b.column && a.file == b.file;
}

}  // namespace saltus
