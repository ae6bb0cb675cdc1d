// A system with contacts or hysteresis as one whose time stands still there.
#pragma once

#include <functional>
#include <mutex>
#include <optional>

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// A FrozenSystem is what a system with contacts or hysteresis is when it is frozen, or why it cannot be. It is made
/// when it is asked for first: methods with events never ask, and every expression of it may hold all hysteresis
/// states.
class FrozenSystem {
 public:
  explicit FrozenSystem(std::function<Expected<System>()> make) : make_(std::move(make)) {}

  /// Returns the system, made under the symbolic lock.
  [[nodiscard]] const Expected<System>& system() const;

 private:
  std::function<Expected<System>()> make_;
  mutable std::once_flag made_;
  mutable std::optional<Expected<System>> system_;
};

/// Returns a frozen system with the parameters and initial values that the system it stands for has by now.
[[nodiscard]] System with_values_of(System frozen, const System& system);

}  // namespace saltus::model
