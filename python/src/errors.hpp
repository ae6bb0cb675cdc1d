// Bad input as exceptions of Python.
#pragma once

#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::python {

/// Raises saltus.ModelError with message, remedy and place.
[[noreturn]] void raise(const Error& error);

/// The value, or the exception.
template <class T>
T value_or_raise(Expected<T> value) {
  if (!value) raise(value.error());
  return std::move(*value);
}
inline void value_or_raise(const Expected<void>& done) {
  if (!done) raise(done.error());
}

}  // namespace saltus::python
