// Models and matrices count with signed numbers, containers with unsigned ones.
#pragma once

#include <concepts>
#include <cstddef>

namespace saltus {

/// Returns the place i >= 0 in a container, where i is what the model or a matrix counts with: values[at(i)]. Not
/// checked.
template <std::signed_integral Integer>
[[nodiscard]] constexpr std::size_t at(Integer i) {
  return static_cast<std::size_t>(i);
}

/// Returns the number i that a matrix counts with, of the place i in a container: matrix.row(index(i)); an
/// linalg::Index. Not checked.
[[nodiscard]] constexpr std::ptrdiff_t index(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }

}  // namespace saltus
