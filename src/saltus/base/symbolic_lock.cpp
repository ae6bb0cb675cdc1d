#include "saltus/base/symbolic_lock.hpp"

#include <mutex>
#include <utility>

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
                                    [](int) { mutex_of_process().unlock(); },
                                    [](int times) -> void* {
                                      for (int k = 0; k < times; ++k) mutex_of_process().unlock();
                                      return nullptr;
                                    },
                                    [](void*, int times) {
                                      for (int k = 0; k < times; ++k) mutex_of_process().lock();
                                    }};
  return chosen;
}

/// How often this thread has the lock.
thread_local int times_held = 0;

}  // namespace

SymbolicLock::SymbolicLock() : token_(means().acquire()) { ++times_held; }
SymbolicLock::~SymbolicLock() {
  --times_held;
  means().release(token_);
}
void SymbolicLock::use(Means chosen) { means() = chosen; }

SymbolicPause::SymbolicPause() : times_(std::exchange(times_held, 0)) {
  if (times_ > 0) token_ = means().let_go(times_);
}
SymbolicPause::~SymbolicPause() {
  if (times_ > 0) means().take_back(token_, times_);
  times_held = times_;
}

}  // namespace saltus
