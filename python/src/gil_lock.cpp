#include "parts.hpp"
#include "saltus/base/symbolic_lock.hpp"

namespace saltus::python {

void lock_symbols_by_interpreter() {
  SymbolicLock::use({[] { return static_cast<int>(PyGILState_Ensure()); },
                     [](int token) { PyGILState_Release(static_cast<PyGILState_STATE>(token)); },
                     [](int) -> void* { return PyEval_SaveThread(); },
                     [](void* state, int) { PyEval_RestoreThread(static_cast<PyThreadState*>(state)); }});
}

}  // namespace saltus::python
