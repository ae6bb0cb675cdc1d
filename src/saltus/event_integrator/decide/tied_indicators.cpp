#include "saltus/event_integrator/decide/tied_indicators.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/decide/projected_fields.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

using evaluation::ModelKernel;
using evaluation::RegionRange;

void note_ties(const ModelKernel& kernel, const ModeState& before, SwitchingPoint& switching_point) {
  switching_point.tied.clear();
  for (const auto& group : kernel.region_groups()) {
    const auto first = switching_point.tied.size();
    for (const int j : switching_point.at_zero) {
      if (group.holds(j)) switching_point.tied.push_back(j);
    }
    if (switching_point.tied.size() > first) switching_point.tied.push_back(reference_of(before, group));
  }
}

namespace {

/// Speeds of psi_j along the fields of all regions of its group: the largest one.
double fastest(const ProjectedFields& fields, const RegionRange& group, const ModeState& before, int j) {
  double rate = 0.0;
  for (int own = group.first; own < group.first + group.count; ++own) {
    std::vector<double> alpha = before.alpha;
    for (int other = group.first; other < group.first + group.count; ++other) alpha[at(other)] = 0.0;
    alpha[at(own)] = 1.0;
    rate = std::max(rate, std::abs(fields.velocities(alpha, {j}).front()));
  }
  return rate;
}

}  // namespace

std::optional<std::pair<int, int>> same_indicators(const ModelKernel& kernel, const ModeState& state,
                                                   const SwitchingPoint& switching_point) {
  const auto& tied = switching_point.tied;
  std::vector<std::pair<int, int>> same;
  for (std::size_t a = 0; a < tied.size(); ++a) {
    for (std::size_t b = a + 1; b < tied.size(); ++b) {
      if (same_group(kernel, tied[a], tied[b])) same.emplace_back(tied[a], tied[b]);
    }
  }
  if (same.empty()) return std::nullopt;
  const auto n = at(kernel.event_functions());
  std::vector<double> values(n), magnitude(n), slope(n);
  for (const unsigned pattern : {0U, 1U, 2U}) {
    constexpr double step = 0x1p-10;
    const double t = switching_point.t + step * (1.0 + std::abs(switching_point.t));
    std::vector<double> x(switching_point.x, switching_point.x + kernel.states());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += displacement(i, x[i], step, pattern);
    kernel.functions(t, x.data(), state.alpha.data(), values.data());
    kernel.scales(t, x.data(), state.alpha.data(), magnitude.data(), slope.data());
    std::erase_if(same, [&](const auto& pair) {
      const auto [i, j] = pair;
      constexpr double nearly = 1e-9;
      const double size = magnitude[at(i)] + magnitude[at(j)] + slope[at(i)] + slope[at(j)];
      return !(std::abs(values[at(i)] - values[at(j)]) <= nearly * size);
    });
  }
  if (same.empty()) return std::nullopt;
  return same.front();
}

void complete_ties(const ModelKernel& kernel, const ModeState& before, SwitchingPoint& switching_point) {
  const auto located = switching_point.at_zero;
  for (const auto& group : kernel.region_groups()) {
    const auto holds = [&](int j) { return group.holds(j); };
    if (group.count < 3 || std::none_of(located.begin(), located.end(), holds)) continue;
    const ProjectedFields fields(kernel, switching_point);
    std::vector<double> values(at(kernel.event_functions()));
    kernel.functions(switching_point.t, switching_point.x, before.alpha.data(), values.data());
    // What two times next to each other differ by, as where events are located. Cycles of a spiral get shorter by a
    // factor of up to ten: with one of its regions within rounding, the next ones are the same point.
    double reach = 8.0;
    constexpr double cycle = 8.0;
    constexpr double farthest = 512.0;
    for (bool more = true; more && reach <= farthest; reach *= cycle) {
      more = false;
      for (int j = group.first; j < group.first + group.count; ++j) {
        if (before.mode[at(j)] == 0 || contains(switching_point.at_zero, j)) {
          continue;
        }
        const double unit = rounding_unit * std::abs(switching_point.t) * fastest(fields, group, before, j);
        if (!(std::abs(values[at(j)]) <= std::max(fields.noise(j), reach * unit))) continue;
        switching_point.at_zero.push_back(j);
        more = true;
      }
    }
  }
  std::sort(switching_point.at_zero.begin(), switching_point.at_zero.end());
}

}  // namespace saltus::event_integrator
