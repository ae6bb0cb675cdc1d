// Elements that begin or end where a root is zero.
#pragma once

#include <vector>

#include "saltus/fesd_integrator/element/time_warp.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"

namespace saltus::fesd_integrator {

/// Says in which time (TimeWarp) elements beside zeros of roots are smooth.
class RootWarps {
 public:
  /// Both must outlive it.
  RootWarps(const RunContext& context, const Position& position);

  /// Returns the warp of an element of length h that begins here; 1 where no root of the current mode is zero.
  [[nodiscard]] int behind(double h);
  /// Returns the warp of an element that ends where a root of the current mode is zero inside `beyond`; 1 without one.
  [[nodiscard]] int before(const Element& beyond);

 private:
  struct Root;
  template <class Take>
  void for_each_root(double t, const double* x, Take&& take);

  const RunContext& context_;
  const Position& position_;
  discretization::StageValues values_;
  discretization::RootValues roots_;
  std::vector<double> zero_roots_;
};

}  // namespace saltus::fesd_integrator
