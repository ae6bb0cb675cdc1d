// States put onto surfaces: ends of elements where gaps rest, and where switches that accumulate come to rest.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

/// Projects states by Newton's method of least norm onto the surfaces of a set that slide, sigma(t, x) = 0, and onto
/// the zeros of functions that rest. Those of the surfaces that
/// no selection moves at once are projected onto d sigma / dt = 0, too.
class RestProjection {
 public:
  struct Place {
    double t = 0.0;
    const double* held = nullptr;
    double size = 0.0;               ///< of the states around: what roundings are relative to
    std::vector<double> selections;  ///< those of fixed modes count
  };
  /// The kernel must outlive it.
  explicit RestProjection(const discretization::StageKernel& kernel);

  /// Projects onto the surfaces. Returns false, and x is anything, where Newton's method finds no point.
  [[nodiscard]] bool onto_surfaces(const ActiveSet& set, const Place& place, std::vector<double>& x);
  /// Does the same, and projects to rest; at most `farthest` away from the surfaces' point.
  [[nodiscard]] bool to_rest(const ActiveSet& set, const Place& place, double farthest, std::vector<double>& x);

 private:
  struct Rate {
    double value = 0.0;
    bool moved = false;  ///< by a selection, at once
  };
  [[nodiscard]] Rate rate_of(std::size_t k, const ActiveSet& set, const Place& place, const std::vector<double>& x);
  [[nodiscard]] bool rest_one(std::size_t k, const ActiveSet& set, const Place& place, double farthest,
                              std::vector<double>& x);
  [[nodiscard]] linalg::Matrix gradients_of(const ActiveSet& set, std::size_t n_x) const;
  /// One Newton step; its length, in the largest component. nullopt where the gradients depend on each other.
  [[nodiscard]] std::optional<double> step(const ActiveSet& set, double size, std::vector<double>& x);

  const discretization::StageKernel& kernel_;
  discretization::StageValues values_;
};

}  // namespace saltus::fesd_integrator
