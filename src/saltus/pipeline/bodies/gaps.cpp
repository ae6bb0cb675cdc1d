#include "saltus/pipeline/bodies/gaps.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace saltus::pipeline {

Gaps::Gaps(const model::System& system, std::vector<double> parameters)
    : parameters_(std::move(parameters)),
      gaps_(system.contacts.contacts.size()),
      function_("saltus_gaps", {system.t, system.x, system.p}, {system.contacts.gap}) {}

double Gaps::depth(double t, const std::vector<double>& x) {
  function_(std::array<const double*, 3>{&t, x.data(), parameters_.data()}, std::array{gaps_.data()});
  double depth = 0.0;
  for (const double gap : gaps_) depth = std::max(depth, -gap);
  return depth;
}

double Gaps::depth(const result::Trajectory& trajectory) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
    deepest = std::max(deepest, depth(trajectory.t[i], trajectory.x[i]));
  }
  return deepest;
}

}  // namespace saltus::pipeline
