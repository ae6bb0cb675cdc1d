#include "saltus/discretization/point_functions.hpp"

#include <array>
#include <exception>
#include <string>
#include <utility>

#include "saltus/discretization/dcs_expressions_internal.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::discretization {

using casadi::SX;
using model::ModelFunction;

struct PointFunctions::Implementation {
  std::vector<double> parameters;
  ModelFunction alpha, outputs, inputs, held_arguments, event_values;
  std::vector<ModelFunction> conditions;  ///< one per event; null for expressions
  evaluation::NativeFunctions native;     // without conditions: they are asked for at events only
  std::size_t event_functions = 0;

  Implementation(const reformulation::Dcs& dcs, std::vector<double> values) : parameters(std::move(values)) {
    const std::vector<SX> point{dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p};
    alpha = ModelFunction("saltus_alpha", {dcs.selection, dcs.held}, {dcs.alpha});
    outputs = ModelFunction("saltus_outputs", point, {with_inputs(dcs, dcs.outputs)});
    inputs = ModelFunction("saltus_inputs", {dcs.t, dcs.held, dcs.p}, {dcs.input});
    std::vector<SX> arguments;
    for (const auto& symbol : dcs.held_symbols) arguments.push_back(with_inputs(dcs, symbol.argument));
    held_arguments = ModelFunction("saltus_held_arguments", {dcs.t, dcs.x, dcs.held, dcs.p},
                                   {arguments.empty() ? SX(0, 1) : SX::vertcat(arguments)});
    std::vector<SX> functions;
    for (const auto& event : dcs.events) {
      const bool condition = event.guards.numel() > 0;
      functions.push_back(with_inputs(dcs, condition ? SX::vec(event.guards) : event.value));
      if (!condition) {
        conditions.emplace_back();
        continue;
      }
      auto with_guards = point;
      with_guards.push_back(event.guard_alpha);
      conditions.emplace_back("condition", with_guards, std::vector<SX>{with_inputs(dcs, event.value)});
    }
    const SX all = functions.empty() ? SX(0, 1) : SX::vertcat(functions);
    event_functions = static_cast<std::size_t>(all.numel());
    event_values = ModelFunction("saltus_event_values", point, {all});
  }
};

PointFunctions::PointFunctions(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
PointFunctions::PointFunctions(PointFunctions&&) noexcept = default;
PointFunctions& PointFunctions::operator=(PointFunctions&&) noexcept = default;
PointFunctions::~PointFunctions() = default;

Expected<PointFunctions> PointFunctions::compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                 evaluation::NativeCode native) {
  try {
    auto functions = std::make_unique<Implementation>(dcs, std::move(parameters));
    auto started = functions->native.start(native, {&functions->alpha, &functions->outputs, &functions->inputs,
                                                    &functions->held_arguments, &functions->event_values});
    if (!started) return tl::unexpected(started.error());
    return PointFunctions(std::move(functions));
  } catch (const std::exception& error) {
    return tl::unexpected(Error{
        ErrorCode::invalid_model, std::string("the model's outputs cannot be compiled: ") + error.what(), "", {}, {}});
  }
}

void PointFunctions::alpha(const double* selection, const double* held, double* alpha) const {
  implementation_->native.call(implementation_->alpha, std::array<const double*, 2>{selection, held},
                               std::array<double*, 1>{alpha});
}

void PointFunctions::outputs(double t, const double* x, const double* selection, const double* held,
                             double* values) const {
  implementation_->native.call(implementation_->outputs,
                               std::array<const double*, 5>{&t, x, selection, held, implementation_->parameters.data()},
                               std::array<double*, 1>{values});
}

void PointFunctions::inputs(double t, const double* held, double* values) const {
  implementation_->native.call(implementation_->inputs,
                               std::array<const double*, 3>{&t, held, implementation_->parameters.data()},
                               std::array<double*, 1>{values});
}

void PointFunctions::held_arguments(double t, const double* x, const double* held, double* arguments) const {
  implementation_->native.call(implementation_->held_arguments,
                               std::array<const double*, 4>{&t, x, held, implementation_->parameters.data()},
                               std::array<double*, 1>{arguments});
}

std::size_t PointFunctions::event_functions() const { return implementation_->event_functions; }

void PointFunctions::event_values(double t, const double* x, const double* selection, const double* held,
                                  double* values) const {
  implementation_->native.call(implementation_->event_values,
                               std::array<const double*, 5>{&t, x, selection, held, implementation_->parameters.data()},
                               std::array<double*, 1>{values});
}

bool PointFunctions::condition(std::size_t event, double t, const double* x, const double* selection,
                               const double* held, const double* guard_steps) const {
  double value = 0.0;
  implementation_->conditions[event](
      std::array<const double*, 6>{&t, x, selection, held, implementation_->parameters.data(), guard_steps},
      std::array<double*, 1>{&value});
  return value > 0.5;
}

}  // namespace saltus::discretization
