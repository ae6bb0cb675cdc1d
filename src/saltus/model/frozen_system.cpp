#include "saltus/model/frozen_system.hpp"

#include <algorithm>
#include <cstddef>

#include "saltus/base/at.hpp"
#include "saltus/base/symbolic_lock.hpp"

namespace saltus::model {

const Expected<System>& FrozenSystem::system() const {
  const SymbolicLock lock;  // before the flag: whoever has that needs no lock any more
  std::call_once(made_, [this] { system_ = make_(); });
  return *system_;
}

System with_values_of(System frozen, const System& system) {
  frozen.parameter_values.assign(system.parameter_values.begin(),
                                 system.parameter_values.begin() + index(frozen.parameter_names.size()));
  // What both show comes first.
  const std::size_t most = std::min(frozen.state_names.size(), system.state_names.size());
  for (std::size_t i = 0; i < most && frozen.state_names[i] == system.state_names[i]; ++i) {
    frozen.initial_state[i] = system.initial_state[i];
  }
  return frozen;
}

}  // namespace saltus::model
