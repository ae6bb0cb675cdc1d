// The fields that meet at a point, projected on the normals of the surfaces there.
#pragma once

#include <optional>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/switching/table/group_decision.hpp"

namespace saltus::event_integrator {

/// Holds what psi_j does along a field of fixed selections: first derivative, and which derivative decides where it
/// goes.
struct Motion {
  switching::Side side;
  int order = 0;  ///< of the first derivative that does not vanish; 0 if none was found
};

/// Sign tests: a normal component below this fraction of its scale counts as 0 (switching.md section 8).
inline constexpr double sign_tolerance = 1e-10;
/// Velocities below this fraction of their scale are rounding.
inline constexpr double velocity_rounding = 1e-14;

/// Evaluates fields, all at one point (switching_point.t, switching_point.x); not finite where a field is undefined
/// there and also just beside the surfaces, on the side that belongs to the selections.
class ProjectedFields {
 public:
  ProjectedFields(const evaluation::ModelKernel& kernel, const SwitchingPoint& switching_point);

  /// Returns the selections of one corner: `base` with the bits of `corner` for the surfaces of `group`, and the
  /// functions nested around those read anew in that region.
  [[nodiscard]] std::vector<double> corner_alpha(const std::vector<double>& base, const std::vector<int>& group,
                                                 std::size_t corner) const;
  /// Returns the normal components of f(alpha) on the surfaces of `group`.
  [[nodiscard]] std::vector<double> velocities(const std::vector<double>& alpha, const std::vector<int>& group) const;
  /// Returns where psi_surface goes along f(alpha). A velocity up to 1e-10 `scale` gives way to the first higher
  /// derivative that moves psi further by far over the switching point's time scale: what turns later than at once is
  /// no tangency. It has to move psi further than rounding, too.
  [[nodiscard]] Motion motion(const std::vector<double>& alpha, int surface, double velocity, double scale) const;
  /// Does the same where the velocity alone says it; nullopt where it gives way. Cost: one comparison.
  [[nodiscard]] static std::optional<Motion> motion_by_velocity(double velocity, double scale);
  /// Returns the motion along the field of a side that the located event has seen psi move by: the one that the
  /// solution arrives by takes psi through zero, and one that ends sliding takes it away from the surface. No higher
  /// derivative says otherwise: it holds a multiple of the velocity that the location has left.
  [[nodiscard]] Motion motion_seen(const std::vector<double>& alpha, int surface, int side, double velocity,
                                   double scale) const;
  /// Returns whether sliding ends here, as the field of this side has become tangent to the surface.
  [[nodiscard]] bool is_exit(int surface, int side) const;

  /// Returns whether the fields on both sides of a surface are nearly tangent to it: their normal components are below
  /// 1e-6 of |grad psi| |f|. Their quotient, the sliding selection, has lost its meaning there. Mixes the units of the
  /// states: to choose between reasons to stop, not to decide a motion.
  [[nodiscard]] bool nearly_two_fold(const std::vector<double>& alpha, int surface) const;

  /// Returns whether the gradient of a surface vanishes here, but not close by (a power of another function), so that
  /// normal components say nothing. To choose between reasons to stop.
  [[nodiscard]] bool gradient_vanishes(const std::vector<double>& alpha, int surface) const;
  /// Returns whether the gradients of several surfaces depend on each other, to 1e-6 of their lengths: the surfaces
  /// touch.
  [[nodiscard]] bool gradients_depend(const std::vector<double>& alpha, const std::vector<int>& surfaces) const;

  /// Returns the table of all 2^m corners of a group.
  [[nodiscard]] switching::CornerTable table(const ModeState& before, const std::vector<int>& group) const;
  /// Returns whether the fields of all corners of the group are one and the same (relative 1e-12).
  [[nodiscard]] bool fields_agree(const ModeState& before, const std::vector<int>& group) const;

  /// Returns the point moved off the surfaces by a few roundings, to the sides that `alpha` says; onto those with a
  /// selection strictly between.
  [[nodiscard]] std::vector<double> point_beside(const std::vector<double>& alpha) const;

  /// Returns the rounding level of psi at the point.
  [[nodiscard]] double noise(int surface) const { return noise_[at(surface)]; }

 private:
  [[nodiscard]] std::optional<bool> sparse_gradients_depend(const std::vector<double>& alpha,
                                                            const std::vector<int>& surfaces) const;
  [[nodiscard]] bool turns_within_rounding(const std::vector<double>& alpha, int surface, double velocity) const;

  const evaluation::ModelKernel& kernel_;
  const SwitchingPoint& switching_point_;
  std::vector<double> noise_;  ///< per event function
  std::vector<double> slope_;
};

}  // namespace saltus::event_integrator
