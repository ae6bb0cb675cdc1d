// Which functions of a kernel run as native code, and the shortcut to one of them.
#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/evaluation/kernel_internal.hpp"
#include "saltus/evaluation/native_steps_internal.hpp"

namespace saltus::evaluation {
namespace {

std::string name_of_direct(const casadi::Function& field) { return field.name() + "_direct"; }

/// States, and operations of the field, up to which the stages of steps are compiled with the field inside. They hold
/// it 18 times, and 36 times more where the solution slides. At these limits that takes the compiler about as long as
/// everything else does. What is around the field matters less the larger it is.
struct Limits {
  int states;
  long operations;
};
constexpr Limits of_steps{12, 96};
constexpr Limits of_sliding_steps{8, 48};

bool within(const Limits& limits, int states, long operations) {
  return 0 < states && states <= limits.states && operations <= limits.operations;
}

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

bool ModelKernel::Implementation::has_small_field() const {
  return within(of_steps, static_cast<int>(compiled->x.numel()), free.field.operations());
}

Expected<void> ModelKernel::Implementation::start_native() {
  const auto& field = free.field.function();
  std::string appended = direct_field(field);
  const auto n = static_cast<int>(compiled->x.numel());
  if (has_small_field()) appended += field_stages_source(name_of_direct(field), n);
  if (within(of_sliding_steps, n, free.field.operations())) appended += sliding_stages_source(name_of_direct(field), n);
  std::vector<model::ModelFunction*> all{&free.field, &free.constants,  &functions,
                                         &scales,     &output_function, &input_function};
  for (auto* function : jumps.functions()) all.push_back(function);
  if (!contact_function.is_null()) all.push_back(&contact_function);
  for (auto* function : contact_solve.functions()) all.push_back(function);
  if (!ranges.is_null()) all.push_back(&ranges);
  const bool has_nesting =
      std::any_of(compiled->inner.begin(), compiled->inner.end(), [](const auto& list) { return !list.empty(); });
  // Otherwise the rows are made once.
  if (!has_fixed_constants() || has_nesting) all.push_back(&affine_rows.function());
  auto started = native.start(wanted, std::move(all), std::move(appended));
  if (started) take_native_field();
  return started;
}

/// Nothing as long as everything is interpreted.
void ModelKernel::Implementation::take_native_field() {
  if (contact_solve.is_needed()) return;
  free.direct = reinterpret_cast<DirectField>(native.symbol(name_of_direct(free.field.function())));
  if (free.direct == nullptr || !has_small_field()) return;
  const auto stages = [&](const std::string& name) {
    return reinterpret_cast<ode::StagesFunction>(native.symbol(name));
  };
  free.steps = NativeSteps{{stages(field_stages.dopri5), stages(field_stages.dop853)},
                           {stages(sliding_stages.dopri5), stages(sliding_stages.dop853)}};
}

}  // namespace saltus::evaluation
