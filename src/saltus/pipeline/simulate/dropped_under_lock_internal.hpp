// Systems that a result keeps: they are dropped by whoever drops it, in any thread.
#pragma once

#include <memory>
#include <utility>

#include "saltus/base/symbolic_lock.hpp"

namespace saltus::pipeline {

/// Returns what holds expressions as a value that takes the SymbolicLock when it is dropped; to be called under it.
template <class Value>
[[nodiscard]] std::shared_ptr<const Value> dropped_under_lock(Value value) {
  return {new Value(std::move(value)), [](const Value* held) {
            const SymbolicLock lock;
            delete held;
          }};
}

}  // namespace saltus::pipeline
