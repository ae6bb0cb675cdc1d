// Contract checks for our own mistakes (lane 1 of the three error lanes).
#pragma once

#include <stdexcept>

namespace saltus {

/// Is thrown where a contract is violated: a mistake of this program, not of its input. Whoever calls the library may
/// go on; what was computed is lost.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
  ~InternalError() override;
};

[[noreturn]] void contract_violation(const char* what, const char* file, int line);

}  // namespace saltus

#if defined(SALTUS_NO_CONTRACTS)
#define SALTUS_ASSERT(condition) static_cast<void>(0)
#else
#define SALTUS_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::saltus::contract_violation(#condition, __FILE__, __LINE__))
#endif
