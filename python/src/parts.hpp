// The parts of the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace saltus::python {

/// The lock of symbolic expressions is the interpreter's, as it is for the package casadi in the same process.
void lock_symbols_by_interpreter();

void add_event(nanobind::module_& module);
void add_result(nanobind::module_& module);
void add_model(nanobind::module_& module);
void add_starts(nanobind::module_& module);
void add_tool(nanobind::module_& module);
void add_options(nanobind::module_& module);
void add_mpcc(nanobind::module_& module);

}  // namespace saltus::python
