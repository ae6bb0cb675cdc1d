// Counts every allocation of the executable. It replaces operator new: one source of a test program may include this.
// Not inlined: g++ 12 takes free() for a mismatch where only one of both is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <malloc.h>
#include <new>

namespace saltus::tests {
inline long allocations = 0;
inline std::size_t allocated_bytes = 0;
inline std::size_t held_bytes = 0, most_held_bytes = 0;

inline void* allocate(std::size_t size) {
  ++allocations;
  allocated_bytes += size;
  void* memory = std::malloc(size == 0 ? 1 : size);
  held_bytes += ::malloc_usable_size(memory);
  most_held_bytes = std::max(most_held_bytes, held_bytes);
  return memory;
}
inline void release(void* memory) {
  held_bytes -= ::malloc_usable_size(memory);
  std::free(memory);
}
}  // namespace saltus::tests

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = saltus::tests::allocate(size)) return memory;
  throw std::bad_alloc();
}
/// As std::stable_sort asks for its buffer.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return saltus::tests::allocate(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { saltus::tests::release(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { saltus::tests::release(memory); }
