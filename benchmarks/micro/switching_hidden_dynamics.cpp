// What does a decision by the hidden dynamics cost, for coupled surfaces and for many that do not depend on each other?
#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "../../tests/atlas/atlas_instances.hpp"
#include "../../tests/unit/switching/hidden_cases.hpp"
#include "../../tests/unit/switching/hidden_instances.hpp"

namespace saltus::switching {
namespace {

/// Decisions one after the other: the mean, and the median of the CPU times of single ones.
template <class Decide>
void measure(benchmark::State& state, std::size_t instances, Decide&& decide) {
  std::size_t next = 0;
  std::vector<double> microseconds;
  for (auto _ : state) {
    const std::clock_t begin = std::clock();
    benchmark::DoNotOptimize(decide(next++ % instances));
    microseconds.push_back(1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  const auto middle = microseconds.begin() + static_cast<std::ptrdiff_t>(microseconds.size() / 2);
  std::nth_element(microseconds.begin(), middle, microseconds.end());
  state.counters["median_us"] = *middle;
}

void entering(benchmark::State& state) {
  const auto surfaces = static_cast<int>(state.range(0));
  const auto instances = random_entries(surfaces, 1000, 20 + static_cast<unsigned>(surfaces));
  measure(state, instances.size(), [&](std::size_t i) { return instances[i].decide(); });
}
BENCHMARK(entering)->Arg(2)->Arg(3)->Arg(4)->Arg(6)->Unit(benchmark::kMicrosecond);

/// Ends of sliding on two surfaces: a selection leaves the square, the roots vanish, the root loses its stability.
void leaving(benchmark::State& state, Tree tree) {
  AtlasInstances random(30);
  std::vector<AtlasInstance> instances;
  while (instances.size() < 1000) instances.push_back(random.next(tree));
  measure(state, instances.size(), [&](std::size_t i) {
    const AtlasInstance& one = instances[i];
    return decide_leaving(2, PlaneField{one.f}, PlaneField{one.rates},
                          {{Arrival::along, Arrival::along}, {one.alpha[0], one.alpha[1]}}, 1e-5);
  });
}
BENCHMARK_CAPTURE(leaving, edge, Tree::edge)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(leaving, fold, Tree::fold)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(leaving, unstable, Tree::unstable)->Unit(benchmark::kMicrosecond);

/// Dry friction of each of m bodies by itself.
void additive(benchmark::State& state) {
  const auto surfaces = static_cast<int>(state.range(0));
  HiddenSituation situation;
  situation.arrival.assign(static_cast<std::size_t>(surfaces), Arrival::from_below);
  situation.arrival.front() = Arrival::along;
  situation.alpha.assign(static_cast<std::size_t>(surfaces), 0.4);
  for (auto _ : state) {
    const auto decision = decide_by_hidden_dynamics(
        surfaces,
        [&](const double* alpha, double* g) {
          for (int j = 0; j < surfaces; ++j) g[j] = 0.8 + 0.01 * j - 2.0 * alpha[j];
        },
        situation);
    benchmark::DoNotOptimize(decision);
  }
}
BENCHMARK(additive)->Arg(5)->Arg(20)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace saltus::switching
