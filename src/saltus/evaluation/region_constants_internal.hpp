// Groups of modes by `indicator`: which region the others are measured against, as parameters of the functions.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {

class RegionConstants {
 public:
  RegionConstants() = default;
  /// Appends the symbols of all groups to p, and zeros to their values.
  RegionConstants(const model::System& system, casadi::SX& p, std::vector<double>& parameters) {
    for (const auto& group : system.mode_groups) {
      if (group.first < 0) continue;
      groups_.push_back({group.first, group.regions});
      references_.push_back(-1);
      places_.push_back(parameters.size());
      p = casadi::SX::vertcat({p, group.reference});
      parameters.resize(parameters.size() + static_cast<std::size_t>(group.regions), 0.0);
    }
  }

  [[nodiscard]] const std::vector<RegionRange>& groups() const { return groups_; }
  [[nodiscard]] int reference(std::size_t group) const { return references_[group]; }
  /// @return whether it is another one than before
  bool set_reference(std::size_t group, int function, std::vector<double>& parameters) {
    if (references_[group] == function) return false;
    references_[group] = function;
    for (int i = 0; i < groups_[group].count; ++i) {
      parameters[places_[group] + static_cast<std::size_t>(i)] = groups_[group].first + i == function ? 1.0 : 0.0;
    }
    return true;
  }

 private:
  std::vector<RegionRange> groups_;
  std::vector<int> references_;
  std::vector<std::size_t> places_;  ///< of their constants among the parameters
};

}  // namespace saltus::evaluation
