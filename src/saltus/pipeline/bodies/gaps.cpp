#include "saltus/pipeline/bodies/gaps.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace saltus::pipeline {

Gaps::Gaps(const model::System& system, std::vector<double> parameters)
    : parameters_(std::move(parameters)),
      x_(system.state_names.size(), 0.0),
      gaps_(system.contacts.contacts.size()),
      function_("saltus_gaps", {system.t, system.x, system.p}, {system.contacts.gap}) {}

double Gaps::depth(double t, const std::vector<double>& x) {
  std::copy_n(x.begin(), std::min(x.size(), x_.size()), x_.begin());
  const double *const time = &t, *const states = x_.data();
  function_(std::array{time, states, static_cast<const double*>(parameters_.data())}, std::array{gaps_.data()});
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
