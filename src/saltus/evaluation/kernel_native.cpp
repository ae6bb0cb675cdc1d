// Which functions of a kernel run as native code, and the shortcut to one of them.
#include <string>

#include <fmt/format.h>

#include "saltus/evaluation/kernel_internal.hpp"

namespace saltus::evaluation {
namespace {

std::string name_of_direct(const casadi::Function& field) { return field.name() + "_direct"; }

/// f once more, with arguments in place of tables of them: the compiler then drops the tests for missing ones, which
/// take longer than the arithmetic of a small model.
std::string direct_field(const casadi::Function& field) {
  return fmt::format(
      "\n__attribute__((flatten, nonnull, visibility(\"default\")))\n"
      "void {0}(double t, const double* restrict x, const double* restrict constants, double* restrict xdot) "
      "{{\n"
      "  const double* arg[{2}] = {{&t, x, constants}};\n"
      "  double* res[{3}] = {{xdot}};\n"
      "  casadi_int iw[{4}];\n"
      "  double w[{5}];\n"
      "  {1}(arg, res, iw, w, 0);\n"
      "}}\n",
      name_of_direct(field), field.name(), field.sz_arg(), field.sz_res(), field.sz_iw() + 1, field.sz_w() + 1);
}

}  // namespace

Expected<void> ModelKernel::Implementation::start_native(NativeCode wanted) {
  auto started =
      native.start(wanted, {&free.field, &free.constants, &functions, &scales, &output_function, &input_function},
                   direct_field(free.field.function()));
  if (started) take_direct_field();
  return started;
}

void ModelKernel::Implementation::take_direct_field() {
  free.direct = reinterpret_cast<DirectField>(native.symbol(name_of_direct(free.field.function())));
}

}  // namespace saltus::evaluation
