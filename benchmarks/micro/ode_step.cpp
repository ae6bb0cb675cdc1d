// What does a Runge-Kutta step cost beside the right-hand side, and what does the search of one event function cost?
#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {
namespace {

constexpr double h = 1e-3;

/// Uncoupled decays: about as cheap as a right-hand side gets.
void decay(double /*t*/, const double* x, double* xdot, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) xdot[i] = -x[i];
}

void attempt(benchmark::State& state, Method method) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto f = [n](double t, const double* x, double* xdot) { decay(t, x, xdot, n); };
  const std::vector<double> x(n, 1.0);
  const std::vector<double> slope(n, -1.0);
  Stepper stepper(method, static_cast<int>(n));
  for (auto _ : state) {
    benchmark::DoNotOptimize(stepper.attempt(f, 0.0, x.data(), slope.data(), h, {}));
    benchmark::ClobberMemory();
  }
  state.counters["per_evaluation"] = benchmark::Counter(static_cast<double>(stepper.evaluations()),
                                                        benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(attempt, dopri5, Method::dopri5)->RangeMultiplier(4)->Range(2, 512);
BENCHMARK_CAPTURE(attempt, dop853, Method::dop853)->RangeMultiplier(4)->Range(2, 512);

void dense_value(benchmark::State& state, Method method) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto f = [n](double t, const double* x, double* xdot) { decay(t, x, xdot, n); };
  std::vector<double> x(n, 1.0);
  const std::vector<double> slope(n, -1.0);
  Stepper stepper(method, static_cast<int>(n));
  DenseStep dense;
  if (stepper.attempt(f, 0.0, x.data(), slope.data(), h, {}) != Attempt::finite ||
      stepper.dense(f, dense) != Attempt::finite) {
    state.SkipWithError("undefined step");
  }
  for (auto _ : state) {
    dense.evaluate(0.3, x.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK_CAPTURE(dense_value, dopri5, Method::dopri5)->Arg(4)->Arg(64);
BENCHMARK_CAPTURE(dense_value, dop853, Method::dop853)->Arg(4)->Arg(64);

/// 1 + theta / 2 - depth theta (1 - theta): inactive for small depths, two zeros for large ones.
std::array<double, event_nodes> samples(double depth) {
  std::array<double, event_nodes> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double theta = interpolation_nodes()[i];
    values[i] = 1.0 + 0.5 * theta - depth * theta * (1.0 - theta);
  }
  return values;
}

void bernstein_conversion(benchmark::State& state) {
  auto values = samples(1.0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(values);
    benchmark::DoNotOptimize(to_bernstein(values));
  }
}
BENCHMARK(bernstein_conversion);

void inactive_event(benchmark::State& state) {
  auto coefficients = to_bernstein(samples(1.0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(coefficients);
    benchmark::DoNotOptimize(certainly_no_sign_change(coefficients, 1, 0, 1e-15));
  }
}
BENCHMARK(inactive_event);

void active_event(benchmark::State& state) {
  auto coefficients = to_bernstein(samples(8.0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(coefficients);
    benchmark::DoNotOptimize(first_sign_change(coefficients, 1, 0, 1e-15));
  }
}
BENCHMARK(active_event);

}  // namespace
}  // namespace saltus::ode
