// Functions that stay at zero while another one does: a gap whose rate is held at zero.
#pragma once

#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"

namespace saltus::fesd_integrator {

/// Finds, of step functions that are zero at a point, those whose rate is a positive multiple of another one's value,
///   d psi_j / dt = c psi_r,  c > 0,
/// where selections act by (1 - alpha_j)(1 - alpha_r) only, as those of a gap and its rate do in frozen time (or by
/// the same with alpha for 1 - alpha). So psi_j leaves zero to the side of psi_r. While psi_r slides, psi_j rests: the
/// side where alpha_r acts is the only one that says anything, and the field there has one selection for one equation.
///
/// Where alpha_j acts on both sides of psi_r, as the gap of a contact with restitution does, it is the one selection
/// that keeps psi_r = 0: alpha_r acts beside it, and no equation is left for it.
class Rests {
 public:
  struct Place {
    double t = 0.0;
    std::span<const double> x;
    const double* held = nullptr;
    double size = 0.0;  ///< of the states around
  };
  /// The kernel must outlive it.
  explicit Rests(const discretization::StageKernel& kernel);

  /// Finds those among `members`. Cost: three evaluations, and four per function found.
  void find(const Place& place, std::span<const Part> parts, const std::vector<int>& members);
  /// Returns the function that j rests on; -1 if there is none.
  [[nodiscard]] int governor(int j) const { return governors_[at(j)]; }
  [[nodiscard]] bool any() const;
  /// Returns whether the first of these functions may be in these modes just behind the point.
  [[nodiscard]] bool allow(const std::vector<int>& members, std::span<const int> modes) const;
  /// Tells a set of these modes what rests in it.
  void put_into(ActiveSet& set) const;

 private:
  void find_slopes(const Place& place);
  [[nodiscard]] bool follows(int j, int r, double size) const;
  [[nodiscard]] std::vector<int> idle_sides(const Place& place, int of, int other);

  const discretization::StageKernel& kernel_;
  discretization::StageValues values_, ahead_, behind_;
  std::vector<int> governors_, sides_;
  std::vector<double> selections_;
  double step_ = 0.0;  ///< of time, between ahead_ and behind_
};

}  // namespace saltus::fesd_integrator
