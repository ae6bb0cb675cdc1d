// Random situations of several coupled surfaces, for tests and benchmarks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/selections/selection_newton.hpp"
#include "saltus/switching/table/multi_affine.hpp"

namespace saltus::switching {

struct HiddenInstance {
  MultiAffine g;
  HiddenSituation situation;

  [[nodiscard]] HiddenDecision decide(const HiddenOptions& options = {}) const {
    return decide_by_hidden_dynamics(
        g.rows(), [&](const double* alpha, double* velocity) { g.evaluate(alpha, velocity); }, situation, options);
  }
};

/// Velocities of `surfaces` surfaces uniform in [-1, 1]; the last is reached from below while sliding on the others
/// along a root that some scaling makes stable (tried until there is one).
inline std::vector<HiddenInstance> random_entries(int surfaces, std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> velocity(-1.0, 1.0);
  std::vector<HiddenInstance> instances;
  const int sliding = surfaces - 1;
  const auto m = static_cast<std::size_t>(surfaces);
  std::vector<double> g(m);
  while (instances.size() < count) {
    HiddenInstance one{MultiAffine(surfaces, surfaces), {}};
    for (int j = 0; j < surfaces; ++j) {
      for (std::size_t k = 0; k < one.g.corners(); ++k) one.g.set_value(j, k, velocity(random));
    }
    std::vector<double> alpha(m, 0.5);
    alpha.back() = 0.0;
    const auto held = [&](const double* free, double* result) {
      std::copy_n(free, sliding, alpha.begin());
      one.g.evaluate(alpha.data(), g.data());
      std::copy_n(g.begin(), sliding, result);
    };
    std::vector<double> free(m - 1, 0.5);
    SelectionNewton newton(sliding);
    if (!newton.solve(held, free.data()) || !(newton.margin() > 0.0)) continue;
    if (!std::all_of(free.begin(), free.end(), [](double a) { return 0.0 < a && a < 1.0; })) continue;
    std::copy(free.begin(), free.end(), alpha.begin());
    one.g.evaluate(alpha.data(), g.data());
    if (!(g.back() > 0.0)) continue;
    one.situation.arrival.assign(m, Arrival::along);
    one.situation.arrival.back() = Arrival::from_below;
    one.situation.alpha = alpha;
    instances.push_back(std::move(one));
  }
  return instances;
}

}  // namespace saltus::switching
