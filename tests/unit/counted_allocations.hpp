// Counts every allocation of the executable. It replaces operator new: one source of a test program may include this.
// Not inlined: g++ 12 takes free() for a mismatch where only one of both is.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace saltus::tests {
inline long allocations = 0;
inline std::size_t allocated_bytes = 0;
}  // namespace saltus::tests

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++saltus::tests::allocations;
  saltus::tests::allocated_bytes += size;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
/// As std::stable_sort asks for its buffer.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++saltus::tests::allocations;
  saltus::tests::allocated_bytes += size;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
