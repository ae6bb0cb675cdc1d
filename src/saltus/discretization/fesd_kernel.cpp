#include <cmath>
#include <exception>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/preparation.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/discretization/fesd_checks_internal.hpp"
#include "saltus/discretization/fesd_kernel_internal.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;

tl::unexpected<Error> refusal(ErrorCode code, std::string message, std::string remedy = "") {
  Error error;
  error.code = code;
  error.message = std::move(message);
  error.remedy = std::move(remedy);
  return tl::unexpected(std::move(error));
}

}  // namespace

Expected<void> check(const FesdOptions& options) {
  if (!(options.gamma_h >= 0.0 && options.gamma_h <= 1.0)) {
    return refusal(ErrorCode::invalid_option, fmt::format("gamma_h = {} is not in [0, 1]", options.gamma_h));
  }
  if (!(options.rho_h > 0.0 && std::isfinite(options.rho_h) && options.sigma_h > 0.0)) {
    return refusal(ErrorCode::invalid_option,
                   fmt::format("rho_h = {} and sigma_h = {} have to be > 0", options.rho_h, options.sigma_h));
  }
  return {};
}

FesdKernel::FesdKernel(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
FesdKernel::~FesdKernel() = default;
const FesdOptions& FesdKernel::options() const { return implementation_->options; }
const std::vector<SelectionPair>& FesdKernel::pairs() const { return implementation_->pairs; }
long FesdKernel::operations() const {
  return implementation_->element.operations() + implementation_->boundary.operations();
}

Expected<std::shared_ptr<FesdKernel>> FesdKernel::compile(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                          const ButcherTableau& tableau, const FesdOptions& options,
                                                          evaluation::NativeCode native) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  try {
    auto built = element_expressions(dcs, tableau, options);
    if (!built) return tl::unexpected(built.error());
    auto kernel = std::make_unique<Implementation>();
    kernel->tableau = tableau;
    kernel->options = options;
    kernel->parameters = std::move(parameters);
    kernel->states = static_cast<int>(dcs.x.numel());
    kernel->held = static_cast<int>(dcs.held.numel());
    kernel->layout = built->layout;
    kernel->depends_on_time = built->depends_on_time;
    kernel->pairs = built->pairs;
    for (const auto& part : dcs.parts) {
      if (part.form == reformulation::Form::stewart) kernel->simplices.emplace_back(part.first, part.count);
    }
    constexpr std::string_view stating = "stating finite elements";  // of a thousand regions that takes a minute
    constexpr std::size_t functions_of_element = 2;
    prepares(stating, 0, functions_of_element);
    kernel->element = LocalFunction("saltus_element", built->element_inputs, built->parameters, built->element);
    prepares(stating, 1, functions_of_element);
    kernel->boundary = LocalFunction("saltus_boundary", built->boundary_inputs, built->parameters,
                                     built->neighbours.joined(built->boundary));
    kernel->boundary_bounds = built->boundary_own_bounds;
    SX indicator = dcs.indicator;
    if (dcs.u.numel() > 0) indicator = SX::substitute(indicator, dcs.u, SX::densify(dcs.input));
    kernel->indicators =
        model::ModelFunction("saltus_indicators", {dcs.t, dcs.x, SX::vertcat({dcs.p, dcs.held})}, {indicator});
    std::vector<model::ModelFunction*> functions{&kernel->indicators};
    kernel->element.join(kernel->native, functions);
    kernel->boundary.join(kernel->native, functions);
    auto started = kernel->native.start(native, std::move(functions));
    if (!started) return tl::unexpected(started.error());
    return std::shared_ptr<FesdKernel>(new FesdKernel(std::move(kernel)));
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& error) {
    return refusal(ErrorCode::invalid_model,
                   std::string("the model's finite element cannot be compiled: ") + error.what());
  }
}

}  // namespace saltus::discretization
