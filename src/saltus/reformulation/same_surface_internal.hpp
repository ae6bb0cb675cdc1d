// Which switching functions vanish together: equal up to a constant factor at seeded points.
#pragma once

#include <optional>
#include <vector>

#include "saltus/model/system.hpp"
#include "saltus/reformulation/expressions_internal.hpp"

namespace saltus::reformulation {

/// Holds switching functions of one system by their values.
class SurfaceSamples {
 public:
  explicit SurfaceSamples(const model::System& system) : system_(system) {}

  struct Match {
    int surface = 0;
    int orientation = 1;  ///< -1: the factor is negative
  };
  /// Returns the surface added before of which psi (over t, x, u, p, held) is a multiple.
  [[nodiscard]] std::optional<Match> find(const SXElem& psi, const std::vector<SXElem>& held) const;
  /// Adds the next surface.
  void add(const SXElem& psi, const std::vector<SXElem>& held);

 private:
  [[nodiscard]] std::vector<double> sample(const SXElem& psi, const std::vector<SXElem>& held) const;

  const model::System& system_;
  std::vector<std::vector<double>> known_;
};

}  // namespace saltus::reformulation
