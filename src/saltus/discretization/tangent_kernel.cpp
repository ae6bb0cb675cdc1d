#include "saltus/discretization/tangent_kernel.hpp"

#include <array>
#include <exception>
#include <string>
#include <utility>

#include "saltus/discretization/dcs_expressions_internal.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/model/graph/model_function.hpp"

namespace saltus::discretization {

using casadi::SX;

struct TangentKernel::Implementation {
  std::vector<double> parameters;
  std::size_t n_x = 0, n_selections = 0, n_held = 0;
  mutable model::ModelFunction everything;
  mutable evaluation::NativeFunctions native;  ///< of `everything`; the others are evaluated once per element at most
  mutable model::ModelFunction direction, held;
};

TangentKernel::TangentKernel(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
TangentKernel::TangentKernel(TangentKernel&&) noexcept = default;
TangentKernel& TangentKernel::operator=(TangentKernel&&) noexcept = default;
TangentKernel::~TangentKernel() = default;

Expected<TangentKernel> TangentKernel::compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                               evaluation::NativeCode native) {
  try {
    auto kernel = std::make_unique<Implementation>();
    kernel->parameters = std::move(parameters);
    kernel->n_x = static_cast<std::size_t>(dcs.x.numel());
    kernel->n_selections = static_cast<std::size_t>(dcs.selection.numel());
    kernel->n_held = dcs.held_symbols.size();
    const SX f = SX::densify(without_lifting(dcs, with_inputs(dcs, dcs.f)));
    const SX psi = SX::densify(with_inputs(dcs, dcs.indicator));
    const SX rate = SX::jtimes(psi, dcs.x, f) + SX::jacobian(psi, dcs.t);
    kernel->everything = model::ModelFunction(
        "saltus_tangent", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p},
        {f, SX::jacobian(f, dcs.t), SX::jacobian(f, dcs.x), SX::jacobian(f, dcs.selection), SX::jacobian(f, dcs.p), psi,
         SX::jacobian(psi, dcs.t), SX::jacobian(psi, dcs.x), SX::jacobian(psi, dcs.p), SX::jacobian(rate, dcs.t),
         SX::jacobian(rate, dcs.x), SX::jacobian(rate, dcs.selection), SX::jacobian(rate, dcs.p)});
    const SX along = SX::sym("along", dcs.selection.numel());
    const SX by_selection = SX::jacobian(f, dcs.selection);
    const SX direction = SX::mtimes(by_selection, along);
    kernel->direction =
        model::ModelFunction("saltus_direction", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p, along},
                             {by_selection, SX::jacobian(direction, dcs.t), SX::jacobian(direction, dcs.x),
                              SX::jacobian(direction, dcs.selection), SX::jacobian(direction, dcs.p)});
    std::vector<SX> arguments;
    for (const auto& symbol : dcs.held_symbols) arguments.push_back(with_inputs(dcs, symbol.argument));
    const SX all = arguments.empty() ? SX(0, 1) : SX::vertcat(arguments);
    kernel->held = model::ModelFunction(
        "saltus_held_tangent", {dcs.t, dcs.x, dcs.held, dcs.p},
        {SX::jacobian(all, dcs.t), SX::jacobian(all, dcs.x), SX::jacobian(all, dcs.held), SX::jacobian(all, dcs.p)});
    auto started = kernel->native.start(native, {&kernel->everything});
    if (!started) return tl::unexpected(started.error());
    return TangentKernel(std::move(kernel));
  } catch (const std::exception& error) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                std::string("the model's derivatives cannot be compiled: ") + error.what(),
                                "",
                                {},
                                {}});
  }
}

std::size_t TangentKernel::states() const { return implementation_->n_x; }
std::size_t TangentKernel::selections() const { return implementation_->n_selections; }
std::size_t TangentKernel::parameters() const { return implementation_->parameters.size(); }
std::size_t TangentKernel::held() const { return implementation_->n_held; }

void TangentKernel::size(TangentValues& values) const {
  const std::size_t n_x = states(), n = selections(), n_p = parameters();
  values.f.resize(n_x);
  values.f_t.resize(n_x);
  values.f_x.resize(n_x * n_x);
  values.f_selection.resize(n_x * n);
  values.f_p.resize(n_x * n_p);
  values.indicator.resize(n);
  values.indicator_t.resize(n);
  values.indicator_x.resize(n * n_x);
  values.indicator_p.resize(n * n_p);
  values.rate_t.resize(n);
  values.rate_x.resize(n * n_x);
  values.rate_selection.resize(n * n);
  values.rate_p.resize(n * n_p);
}

void TangentKernel::evaluate(double t, const double* x, const double* selection, const double* held,
                             TangentValues& values) const {
  auto& kernel = *implementation_;
  kernel.native.call(
      kernel.everything, std::array<const double*, 5>{&t, x, selection, held, kernel.parameters.data()},
      std::array<double*, 13>{values.f.data(), values.f_t.data(), values.f_x.data(), values.f_selection.data(),
                              values.f_p.data(), values.indicator.data(), values.indicator_t.data(),
                              values.indicator_x.data(), values.indicator_p.data(), values.rate_t.data(),
                              values.rate_x.data(), values.rate_selection.data(), values.rate_p.data()});
}

void TangentKernel::direction(double t, const double* x, const double* selection, const double* held,
                              const double* along, DirectionValues& values) const {
  auto& kernel = *implementation_;
  const std::size_t n_x = states(), n = selections();
  values.f_selection.resize(n_x * n);
  values.by_t.resize(n_x);
  values.by_x.resize(n_x * n_x);
  values.by_selection.resize(n_x * n);
  values.by_p.resize(n_x * parameters());
  kernel.direction(std::array<const double*, 6>{&t, x, selection, held, kernel.parameters.data(), along},
                   std::array<double*, 5>{values.f_selection.data(), values.by_t.data(), values.by_x.data(),
                                          values.by_selection.data(), values.by_p.data()});
}

void TangentKernel::held_tangent(double t, const double* x, const double* held, HeldTangent& values) const {
  auto& kernel = *implementation_;
  values.by_t.resize(kernel.n_held);
  values.by_x.resize(kernel.n_held * states());
  values.by_held.resize(kernel.n_held * kernel.n_held);
  values.by_p.resize(kernel.n_held * parameters());
  kernel.held(
      std::array<const double*, 4>{&t, x, held, kernel.parameters.data()},
      std::array<double*, 4>{values.by_t.data(), values.by_x.data(), values.by_held.data(), values.by_p.data()});
}

}  // namespace saltus::discretization
