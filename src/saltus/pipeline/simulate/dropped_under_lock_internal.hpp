// Systems that a result keeps: they are dropped by whoever drops it, in any thread.
#pragma once

#include <memory>
#include <utility>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/system.hpp"

namespace saltus::pipeline {

/// Returns what holds expressions as a value that takes the SymbolicLock when it is dropped; to be called under it.
template <class Value>
[[nodiscard]] std::shared_ptr<const Value> dropped_under_lock(Value value) {
  return {new Value(std::move(value)), [](const Value* held) {
            const SymbolicLock lock;
            delete held;
          }};
}

/// Returns a copy that takes the SymbolicLock where it is made, too.
[[nodiscard]] inline std::shared_ptr<const model::System> own_copy(const model::System& system) {
  const SymbolicLock lock;
  return dropped_under_lock(model::System(system));
}

}  // namespace saltus::pipeline
