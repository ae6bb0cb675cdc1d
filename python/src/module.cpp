// The extension module saltus._core. What users see is the Python beside it.
#include "parts.hpp"

NB_MODULE(_core, module) {
  saltus::python::lock_symbols_by_interpreter();
  saltus::python::add_result(module);
  saltus::python::add_model(module);
  saltus::python::add_starts(module);
  saltus::python::add_tool(module);
  saltus::python::add_options(module);
  saltus::python::add_mpcc(module);
}
