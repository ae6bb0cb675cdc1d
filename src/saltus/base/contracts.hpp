// Contract checks for our own mistakes (lane 1 of the three error lanes).
#pragma once

#include <cstdio>
#include <cstdlib>

namespace saltus {
[[noreturn]] inline void contract_violation(const char* what, const char* file, int line) {
  std::fprintf(stderr, "saltus: internal error: %s (%s:%d)\n", what, file, line);
  std::abort();
}
}  // namespace saltus

#if defined(SALTUS_NO_CONTRACTS)
#define SALTUS_ASSERT(condition) static_cast<void>(0)
#else
#define SALTUS_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::saltus::contract_violation(#condition, __FILE__, __LINE__))
#endif
