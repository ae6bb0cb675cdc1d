#include "parts.hpp"
#include "saltus/base/symbolic_lock.hpp"

namespace saltus::python {

void lock_symbols_by_interpreter() {
  SymbolicLock::use({[] { return static_cast<int>(PyGILState_Ensure()); },
                     [](int token) { PyGILState_Release(static_cast<PyGILState_STATE>(token)); }});
}

}  // namespace saltus::python
