// Which functions of a kernel run as native code, and from when on.
#include <string>
#include <utility>

#include <casadi/core/code_generator.hpp>
#include <fmt/format.h>

#include "saltus/evaluation/kernel_internal.hpp"

namespace saltus::evaluation {
namespace {

/// Interpreted operations (about 5 ns each) after which looking into the cache, then compiling (tenths of a second)
/// pays.
constexpr double look_after = 2e6;
constexpr double compile_after = 1e8;

/// f once more, with arguments in place of tables of them: the compiler then drops the tests for missing ones, which
/// take longer than the arithmetic of a small model.
std::string direct_field(const casadi::Function& field) {
  return fmt::format(
      "\n__attribute__((flatten, nonnull, visibility(\"default\")))\n"
      "void {0}_direct(double t, const double* restrict x, const double* restrict constants, double* restrict xdot) "
      "{{\n"
      "  const double* arg[{1}] = {{&t, x, constants}};\n"
      "  double* res[{2}] = {{xdot}};\n"
      "  casadi_int iw[{3}];\n"
      "  double w[{4}];\n"
      "  {0}(arg, res, iw, w, 0);\n"
      "}}\n",
      field.name(), field.sz_arg(), field.sz_res(), field.sz_iw() + 1, field.sz_w() + 1);
}

}  // namespace

void ModelKernel::Implementation::write_source() {
  if (!source.empty()) return;
  casadi::CodeGenerator generator("saltus_model.c", {{"with_header", false}});
  for (const auto* function : native_functions()) generator.add(function->function());
  source = generator.dump() + direct_field(free.field.function());
}

void ModelKernel::Implementation::use(NativeLibrary loaded) {
  for (auto* function : native_functions()) {
    function->use_native(reinterpret_cast<ModelFunction::Native>(loaded.symbol(function->function().name())));
  }
  free.direct = reinterpret_cast<DirectField>(loaded.symbol(free.field.function().name() + "_direct"));
  library = std::move(loaded);
}

Expected<void> ModelKernel::Implementation::start_native(NativeCode wanted) {
  native = wanted == NativeCode::automatic ? wanted : NativeCode::off;
  next_attempt = look_after;
  if (wanted != NativeCode::on) return {};
  write_source();
  auto found = find_native(source);
  if (!found) {
    auto compiled = compile_native(source);
    if (!compiled) return tl::unexpected(compiled.error());
    found = std::move(*compiled);
  }
  use(std::move(*found));
  return {};
}

/// native = auto: the cache after some work, the compiler after more. Results are bit-identical, so the moment is free.
void ModelKernel::Implementation::look_for_native() {
  write_source();
  auto found = find_native(source);
  if (!found && operations >= compile_after) {
    if (auto compiled = compile_native(source)) found = std::move(*compiled);
    native = NativeCode::off;  // one attempt: without a compiler the interpreter goes on
  }
  next_attempt = compile_after;
  if (!found) return;
  native = NativeCode::off;
  use(std::move(*found));
}

}  // namespace saltus::evaluation
