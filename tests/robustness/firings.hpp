// How often thresholds have to fire where their resets set off others.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hybrid_systems.hpp"
#include "states.hpp"

namespace saltus::robustness {

/// How often each threshold has to fire at one time: as often as its state comes to lie above it, which jumps of others
/// may undo, and do again, before it does. Within 1e-9 of it a threshold may count as reached.
class Firings {
 public:
  explicit Firings(const Hybrid& hybrid) : hybrid_(hybrid), of_(hybrid.thresholds.size()) {}

  /// At a time at which jumps begin: the motion has led from below to `x`.
  void begin(const State& x) {
    for (std::size_t k = 0; k < of_.size(); ++k) {
      of_[k] = {};
      see(k, x);
    }
  }
  /// Behind a jump.
  void see(const State& x) {
    for (std::size_t k = 0; k < of_.size(); ++k) see(k, x);
  }
  [[nodiscard]] std::string fire(std::size_t k) {
    ++of_[k].fired;
    return of_[k].fired <= of_[k].most ? "" : "fires below the threshold";
  }
  /// Behind the last jump of a time.
  [[nodiscard]] std::string end() const {
    for (std::size_t k = 0; k < of_.size(); ++k) {
      if (of_[k].fired >= of_[k].least) continue;
      return fmt::format("threshold {} is exceeded {} times and fires {} times", k, of_[k].least, of_[k].fired);
    }
    return "";
  }

 private:
  struct OfThreshold {
    bool below = true, above = false;  ///< for certain
    double x = -INFINITY;
    int least = 0, most = 0, fired = 0;
  };

  void see(std::size_t k, const State& x) {
    OfThreshold& of = of_[k];
    const Threshold& threshold = hybrid_.thresholds[k];
    const double now = x[threshold.state];
    if (now == of.x) return;
    const double near = 1e-9 * size_of(x);
    const bool above = now > threshold.value + near, below = now < threshold.value - near;
    if (of.below && above) ++of.least;
    if (!of.above && !below) ++of.most;
    of.below = below;
    of.above = above;
    of.x = now;
  }

  const Hybrid& hybrid_;
  std::vector<OfThreshold> of_;
};

}  // namespace saltus::robustness
