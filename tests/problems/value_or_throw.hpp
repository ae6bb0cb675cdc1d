#pragma once

#include <stdexcept>
#include <utility>

#include "saltus/base/error.hpp"

namespace saltus::problems {

/// For models that are meant to be good.
/// @throws std::runtime_error with the text of the error
template <class T>
T value_or_throw(Expected<T> expected) {
  if (!expected) throw std::runtime_error(to_text(expected.error()));
  return *std::move(expected);
}

}  // namespace saltus::problems
