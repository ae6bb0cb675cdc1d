// Functions that stay at zero while another one does: a gap whose rate is held at zero.
#pragma once

#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"

namespace saltus::fesd_integrator {

/// Finds, of functions that are zero at a point, those whose rate is a positive multiple of another one's value,
///   d psi_j / dt = c psi_r,  c > 0,
/// where selections act by (1 - alpha_j)(1 - alpha_r) only, as those of a gap and its rate do in frozen time (or by
/// the same with alpha for 1 - alpha). So psi_j leaves zero to the side of psi_r. While psi_r slides, psi_j rests: the
/// side where alpha_r acts is the only one that says anything, and the field there has one selection for one equation.
///
/// Where alpha_j acts on both sides of psi_r, as the gap of a contact with restitution does, it is the one selection
/// that keeps psi_r = 0: alpha_r acts beside it, and no equation is left for it. Of regions that are sign patterns
/// those on one side of psi_r alone are active then, where alpha_j acts most.
///
/// The functions are numbered: those of step selections as these are, behind them the surfaces of every simplex.
class Rests {
 public:
  struct Place {
    double t = 0.0;
    std::span<const double> x;
    const double* held = nullptr;
    double size = 0.0;  ///< of the states around
  };
  /// The kernel and the parts must outlive it.
  Rests(const discretization::StageKernel& kernel, std::span<const Part> parts);

  /// Returns the number of the function of a surface of a simplex.
  [[nodiscard]] int function(int part, int surface) const { return first_of_[at(part)] + surface; }
  /// Finds those among the functions of `members`, selections. Cost: three evaluations, and up to four per step
  /// function found.
  void find(const Place& place, const std::vector<int>& members);
  /// Returns the function that j rests on; -1 if there is none.
  [[nodiscard]] int governor(int j) const { return governors_[at(j)]; }
  /// Returns whether j is the selection that keeps its governor at zero, and the side of the governor where it does
  /// among regions.
  [[nodiscard]] bool holds(int j) const { return governors_[at(j)] >= 0 && sides_[at(j)] == 0; }
  [[nodiscard]] int held_side(int j) const { return held_sides_[at(j)]; }
  [[nodiscard]] bool any() const;
  /// Returns whether the first of these functions may be in these modes just behind the point.
  [[nodiscard]] bool allow(const std::vector<int>& functions, std::span<const int> modes) const;
  /// Tells a set of these modes what rests in it.
  void put_into(ActiveSet& set) const;

 private:
  struct Function {
    int part = 0;
    Surface surface{};
    int number = 0;  ///< among the surfaces of its simplex
  };
  [[nodiscard]] std::vector<int> zeros_among(const std::vector<int>& members) const;
  void find_slopes(const Place& place);
  [[nodiscard]] bool follows(int j, int r, double size) const;
  [[nodiscard]] std::vector<int> idle_sides(const Place& place, int of, int other);
  [[nodiscard]] bool acts_on(int side, int of, int other) const;
  [[nodiscard]] double jump_on(int side, int j, int r) const;
  void put_into_simplex(int p, ActiveSet& set, std::vector<Surface>& resting, std::vector<int>& unasked) const;

  const discretization::StageKernel& kernel_;
  std::span<const Part> parts_;
  std::vector<Function> functions_;
  std::vector<int> first_of_;  ///< function of each part's first surface
  discretization::StageValues values_, ahead_, behind_;
  std::vector<int> governors_, sides_, held_sides_;
  std::vector<double> selections_;
  double step_ = 0.0;  ///< of time, between ahead_ and behind_
};

}  // namespace saltus::fesd_integrator
