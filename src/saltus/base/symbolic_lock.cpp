#include "saltus/base/symbolic_lock.hpp"

#include <mutex>

namespace saltus {
namespace {

std::recursive_mutex& mutex_of_process() {
  static std::recursive_mutex mutex;
  return mutex;
}

SymbolicLock::Means& means() {
  static SymbolicLock::Means chosen{[] {
                                      mutex_of_process().lock();
                                      return 0;
                                    },
                                    [](int) { mutex_of_process().unlock(); }};
  return chosen;
}

}  // namespace

SymbolicLock::SymbolicLock() : token_(means().acquire()) {}
SymbolicLock::~SymbolicLock() { means().release(token_); }
void SymbolicLock::use(Means chosen) { means() = chosen; }

}  // namespace saltus
