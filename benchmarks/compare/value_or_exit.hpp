// For the contenders that are Saltus itself.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "saltus/base/error.hpp"

namespace compare {

/// The value, or the error on stderr and exit code 2.
template <class Value>
Value value_or_exit(saltus::Expected<Value> expected) {
  if (expected) return std::move(*expected);
  std::fprintf(stderr, "%s\n", saltus::to_text(expected.error()).c_str());
  std::exit(2);
}

}  // namespace compare
