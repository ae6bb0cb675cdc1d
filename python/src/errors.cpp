#include "errors.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

namespace nb = nanobind;

namespace saltus::python {
namespace {

std::string_view name(ErrorCode code) {
  switch (code) {
    case ErrorCode::parse_failure:
      return "parse_failure";
    case ErrorCode::unknown_name:
      return "unknown_name";
    case ErrorCode::invalid_model:
      return "invalid_model";
    case ErrorCode::invalid_option:
      return "invalid_option";
    case ErrorCode::not_available:
      return "not_available";
    case ErrorCode::io_failure:
      return "io_failure";
  }
  __builtin_unreachable();
}

}  // namespace

void raise(const Error& error) {
  const nb::object type = nb::module_::import_("saltus._errors").attr("ModelError");
  const auto code = name(error.code);
  const auto& place = error.location;
  const nb::object exception = type(to_text(error), error.message, error.remedy, place.file, place.line, place.column,
                                    nb::str(code.data(), code.size()));
  PyErr_SetObject(type.ptr(), exception.ptr());
  throw nb::python_error();
}

}  // namespace saltus::python
