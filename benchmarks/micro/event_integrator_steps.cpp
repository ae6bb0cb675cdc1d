// What does a threshold that is never met cost per step?
#include <string>
#include <utility>

#include "integrate_internal.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;

/// Two oscillators that drive each other, and `thresholds` thresholds of each state beyond its reach, half of them on
/// either side, that would feed the next state.
model::System oscillators(int thresholds) {
  Builder b("oscillators");
  constexpr int n = 4;
  SX x[n];
  for (int i = 0; i < n; ++i) x[i] = b.state("x" + std::to_string(i), {0.5 + 0.1 * i});
  for (int i = 0; i < n; ++i) {
    SX production = 0.0;
    for (int k = 0; k < thresholds; ++k) {
      const double threshold = (k % 2 == 0 ? 1.0 : -1.0) * (10.0 + 0.01 * k);
      production = production + 0.001 * b.step(x[(i + n - 1) % n] - threshold);
    }
    const SX rotation = i % 2 == 0 ? x[i + 1] : -x[i - 1];
    b.dynamics("x" + std::to_string(i), production - 0.0005 * thresholds + rotation);
  }
  return std::move(*b.build());
}

void inactive(benchmark::State& state, ode::Method method) {
  const auto thresholds = static_cast<int>(state.range(0));
  const Integration result = integrate_repeatedly(state, oscillators(thresholds), method);
  if (!result.events.empty()) state.SkipWithError("a threshold was met");
}
BENCHMARK_CAPTURE(inactive, dopri5, ode::Method::dopri5)
    ->Arg(0)
    ->Arg(10)
    ->Arg(100)
    ->Arg(500)
    ->Arg(2000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(inactive, dop853, ode::Method::dop853)
    ->Arg(0)
    ->Arg(10)
    ->Arg(100)
    ->Arg(500)
    ->Arg(2000)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace saltus::event_integrator
