// What does one decision on the intersection of two surfaces cost, by its tree, with all other admissible modes?
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/spiral.hpp"

namespace saltus::switching {
namespace {

using Velocities = std::array<std::array<double, 4>, 2>;

/// Random fields on which the situation can arise, enough of them that no branch is predicted.
template <class Arises>
std::vector<PlaneTable> tables(Arises&& arises) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<PlaneTable> result;
  while (result.size() < 4096) {
    Velocities f{};
    for (auto& row : f) {
      for (double& velocity : row) velocity = uniform(random);
    }
    if (arises(f)) result.push_back(plane_table(f));
  }
  return result;
}

template <class Decide>
void over(benchmark::State& state, const std::vector<PlaneTable>& tables, Decide&& decide) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decide(tables[i]));
    i = (i + 1) % tables.size();
  }
}

bool enters(const Velocities& f) {
  return f[0][0] > 0.0 && f[0][1] < 0.0 && f[0][0] * f[1][1] - f[0][1] * f[1][0] > 0.0;
}
bool slides(const Velocities& f) {
  const auto root = intersection_roots(plane_table(f)).rising;
  return root && root->inside() && root->stabilisable();
}

void entering(benchmark::State& state) {
  over(state, tables(enters), [](const PlaneTable& table) { return decide_entering(table, {0, -1}); });
}
BENCHMARK(entering);

// The exits are decided the same way whether or not the fields are exactly those of the event.
void exit_edge(benchmark::State& state) {
  over(state, tables(slides), [](const PlaneTable& table) { return decide_exit_edge(table, {1, -1}); });
}
BENCHMARK(exit_edge);

void exit_fold(benchmark::State& state) {
  over(state, tables(slides), [](const PlaneTable& table) { return decide_exit_fold(table); });
}
BENCHMARK(exit_fold);

void exit_unstable(benchmark::State& state) {
  over(state, tables(slides), [](const PlaneTable& table) { return decide_exit_unstable(table); });
}
BENCHMARK(exit_unstable);

void corner_arrival(benchmark::State& state) {
  over(state, tables([](const Velocities& f) { return f[0][0] > 0.0 && f[1][0] > 0.0; }), [](const PlaneTable& table) {
    return decide_corner_arrival(table, {-1, -1});
  });
}
BENCHMARK(corner_arrival);

void start(benchmark::State& state) {
  over(state, tables([](const Velocities&) { return true; }),
       [](const PlaneTable& table) { return decide_intersection_start(table); });
}
BENCHMARK(start);

void roots(benchmark::State& state) {
  over(state, tables(slides), [](const PlaneTable& table) { return intersection_roots(table); });
}
BENCHMARK(roots);

void admissible(benchmark::State& state) {
  over(state, tables(slides), [](const PlaneTable& table) { return admissible_modes(table); });
}
BENCHMARK(admissible);

}  // namespace
}  // namespace saltus::switching
