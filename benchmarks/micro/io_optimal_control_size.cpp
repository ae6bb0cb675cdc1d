// What do building and evaluating an optimal control problem cost per interval? The cart-pole, from 20 to 2000
// intervals.
#include <malloc.h>

#include <benchmark/benchmark.h>

#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/ocp_problem.hpp"

namespace saltus {
namespace {

struct CartPole {
  model::Ocp ocp;
  pipeline::OptimizeOptions options;
};

CartPole cart_pole(long intervals) {
  auto read = *io::read_model(SALTUS_SOURCE_DIR "/models/cart-pole.toml");
  CartPole problem{*model::build_ocp(read.description), *read.optimize};
  problem.options.control_intervals = intervals;
  return problem;
}

/// Large blocks are not among those of the heap.
double used_bytes() {
  const auto used = mallinfo2();
  return static_cast<double>(used.uordblks) + static_cast<double>(used.hblkhd);
}

void build(benchmark::State& state) {
  const auto problem = cart_pole(state.range(0));
  double bytes = 0.0;
  for (auto _ : state) {
    const double before = used_bytes();
    const auto stated = *pipeline::state_problem(problem.ocp, problem.options);
    bytes = used_bytes() - before;
    benchmark::DoNotOptimize(stated.problem->variables());
  }
  state.counters["bytes"] = bytes;
  state.SetComplexityN(state.range(0));
}

/// Objective, gradient, rows, Jacobian and Hessian at the start.
void evaluate(benchmark::State& state) {
  const auto problem = cart_pole(state.range(0));
  const auto stated = *pipeline::state_problem(problem.ocp, problem.options);
  auto& one = *stated.problem;
  const linalg::Vector w = one.start(), y = linalg::Vector::ones(one.rows());
  linalg::Vector gradient(one.variables()), c(one.rows()), jacobian(one.jacobian_pattern().entries()),
      hessian(one.hessian_pattern().entries());
  for (auto _ : state) {
    benchmark::DoNotOptimize(one.objective(w));
    one.objective_gradient(w, gradient);
    one.functions(w, c);
    one.jacobian(w, jacobian);
    one.hessian(w, 1.0, y, hessian);
    benchmark::ClobberMemory();
  }
  state.SetComplexityN(state.range(0));
}

BENCHMARK(build)
    ->Arg(20)
    ->Arg(63)
    ->Arg(200)
    ->Arg(632)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);
BENCHMARK(evaluate)
    ->Arg(20)
    ->Arg(63)
    ->Arg(200)
    ->Arg(632)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace saltus
