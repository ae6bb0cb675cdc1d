#include "saltus/discretization/tangent_kernel.hpp"

#include <array>
#include <exception>
#include <string>
#include <utility>

#include "saltus/discretization/dcs_expressions_internal.hpp"
#include "saltus/evaluation/native_functions.hpp"
#include "saltus/model/model_function.hpp"

namespace saltus::discretization {

using casadi::SX;

struct TangentKernel::Implementation {
  std::vector<double> parameters;
  std::size_t n_x = 0, n_selections = 0;
  std::vector<bool> states_of_held, parameters_of_held;
  mutable model::ModelFunction everything;
  mutable evaluation::NativeFunctions native;
};

namespace {

/// Which of `symbols` occur in any of the arguments of what is held.
std::vector<bool> occurring(const reformulation::Dcs& dcs, const SX& symbols) {
  std::vector<SX> arguments;
  for (const auto& symbol : dcs.held_symbols) arguments.push_back(with_inputs(dcs, symbol.argument));
  const SX all = SX::vertcat(arguments);
  std::vector<bool> found;
  for (casadi_int i = 0; i < symbols.numel(); ++i) found.push_back(SX::depends_on(all, symbols(i)));
  return found;
}

}  // namespace

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
    kernel->states_of_held = occurring(dcs, dcs.x);
    kernel->parameters_of_held = occurring(dcs, dcs.p);
    const SX f = SX::densify(without_lifting(dcs, with_inputs(dcs, dcs.f)));
    const SX psi = SX::densify(with_inputs(dcs, dcs.indicator));
    const SX rate = SX::jtimes(psi, dcs.x, f) + SX::jacobian(psi, dcs.t);
    kernel->everything = model::ModelFunction(
        "saltus_tangent", {dcs.t, dcs.x, dcs.selection, dcs.held, dcs.p},
        {f, SX::jacobian(f, dcs.t), SX::jacobian(f, dcs.x), SX::jacobian(f, dcs.selection), SX::jacobian(f, dcs.p), psi,
         SX::jacobian(psi, dcs.t), SX::jacobian(psi, dcs.x), SX::jacobian(psi, dcs.p), SX::jacobian(rate, dcs.t),
         SX::jacobian(rate, dcs.x), SX::jacobian(rate, dcs.selection), SX::jacobian(rate, dcs.p)});
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
const std::vector<bool>& TangentKernel::states_of_held() const { return implementation_->states_of_held; }
const std::vector<bool>& TangentKernel::parameters_of_held() const { return implementation_->parameters_of_held; }

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

}  // namespace saltus::discretization
