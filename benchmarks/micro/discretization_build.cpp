// What does building the problem of a chain of n elements cost: one element kernel and its copies, against the same
// expressions written out for every element?
#include <benchmark/benchmark.h>
#include <casadi/core/function.hpp>

#include "saltus/discretization/element_expressions_internal.hpp"
#include "saltus/discretization/fesd_problem.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::discretization {
namespace {

using casadi::SX;

/// The gene network of models/irma.toml: five states, seven thresholds.
model::System irma() {
  model::Builder builder("irma");
  const std::array<SX, 5> x{builder.state("x1", {0.011}), builder.state("x2", {0.09}), builder.state("x3", {0.04}),
                            builder.state("x4", {0.05}), builder.state("x5", {0.015})};
  const SX gal4 = builder.step(x[0] - 0.01), low = builder.step(x[1] - 0.01), middle = builder.step(x[1] - 0.06),
           high = builder.step(x[1] - 0.08), ash1 = builder.step(x[2] - 0.035), cbf1 = builder.step(x[3] - 0.04),
           gal80 = builder.step(x[4] - 0.01);
  const double galactose = 1.0;
  builder.dynamics("x1", 1.1e-4 + 9e-4 * cbf1 - 0.05 * x[0]);
  builder.dynamics("x2", 3e-4 + 0.15 * gal4 * (1.0 - (1.0 - galactose) * gal80) - 0.04 * x[1]);
  builder.dynamics("x3", 6e-4 + 0.018 * middle - 0.05 * x[2]);
  builder.dynamics("x4", 5e-4 * low + 0.03 * low * (1.0 - ash1) - 0.02 * x[3]);
  builder.dynamics("x5", 7.5e-4 + 0.015 * high - 0.6 * x[4]);
  return *builder.build();
}

struct Subject {
  reformulation::Dcs dcs;
  std::vector<double> parameters;
  ButcherTableau tableau;
  FesdOptions options;
};

const Subject& subject() {
  static const Subject one = [] {
    const auto system = irma();
    return Subject{*reformulation::reformulate(system, {}),
                   system.parameter_values,
                   *butcher_tableau(TableauFamily::radau_iia, 2),
                   {}};
  }();
  return one;
}

std::shared_ptr<FesdKernel> kernel() {
  const auto& [dcs, parameters, tableau, options] = subject();
  return *FesdKernel::compile(dcs, parameters, tableau, options);
}

/// Everything, from the model's complementarity system to a problem that can be evaluated.
void kernel_and_copies(benchmark::State& state) {
  static_cast<void>(subject());
  for (auto _ : state) {
    FesdProblem problem(kernel(), static_cast<int>(state.range(0)));
    benchmark::DoNotOptimize(problem.jacobian_pattern().entries());
  }
}

/// The part that depends on the number of elements.
void copies(benchmark::State& state) {
  const auto one = kernel();
  for (auto _ : state) {
    FesdProblem problem(one, static_cast<int>(state.range(0)));
    benchmark::DoNotOptimize(problem.jacobian_pattern().entries());
  }
}

/// The element's rows substituted once per element, then Jacobian, Hessian and functions of all of them together.
/// Boundaries are left out: this is less than the whole problem.
void written_out(benchmark::State& state) {
  const auto& [dcs, parameters, tableau, options] = subject();
  for (auto _ : state) {
    const auto built = *element_expressions(dcs, tableau, options);
    std::vector<SX> one = built.element.g;
    one.insert(one.end(), built.element.G.begin(), built.element.G.end());
    one.insert(one.end(), built.element.H.begin(), built.element.H.end());
    const SX element = SX::vertcat(one);
    std::vector<SX> variables, rows;
    for (long n = 0; n < state.range(0); ++n) {
      variables.push_back(SX::sym("w", built.element_inputs.numel()));
      rows.push_back(SX::substitute(element, built.element_inputs, variables.back()));
    }
    const SX w = SX::vertcat(variables), c = SX::vertcat(rows), y = SX::sym("y", c.numel());
    const casadi::Function values("values", {w, built.parameters}, {c});
    const casadi::Function jacobian("jacobian", {w, built.parameters}, {SX::jacobian(c, w)});
    const casadi::Function hessian("hessian", {w, built.parameters, y}, {SX::tril(SX::hessian(SX::dot(y, c), w))});
    benchmark::DoNotOptimize(values.n_instructions() + jacobian.n_instructions() + hessian.n_instructions());
  }
}

BENCHMARK(kernel_and_copies)->Arg(3)->Arg(30)->Arg(300)->Arg(3000)->Unit(benchmark::kMillisecond);
BENCHMARK(copies)->Arg(3)->Arg(30)->Arg(300)->Arg(3000)->Unit(benchmark::kMillisecond);
BENCHMARK(written_out)->Arg(3)->Arg(30)->Arg(300)->Arg(3000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saltus::discretization
