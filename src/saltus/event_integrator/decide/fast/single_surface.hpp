// The usual event, decided without detours: one surface is met or left, and nothing else happens there.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Decides what decide_mode() decides, with the same bits, where
///   - one surface is met from beside it and crossed or slid on, or left where one of its fields is tangent,
///   - no other surface is at zero but such on which the solution slides, and those and this one do not influence each
///     other; no function is nested around any of them,
///   - f is affine in the selection, and both normal components are clear of zero (at an exit the other one, and a
///   later
///     derivative of the tangent one).
/// Cost: one evaluation of f, or two where the mode before slides, one of the sliding field if there are other
/// surfaces; at an exit a second derivative, too. In large systems, where f is known at the point, few rows of f. Owns
/// its work space.
class SingleSurface {
 public:
  explicit SingleSurface(const SwitchingContext& switching_context);

  /// Holds the field of the mode before at the switching point, of which `before` has the selections.
  struct Motion {
    const std::vector<double>& slope;
    SlidingSolve solve;
  };
  /// Fills `transition`, whose storage is used again.
  /// @param known  null where the mode before, or the field, has changed at the point
  /// @return whether the switching point is of this kind; if not, `transition` is in no particular state.
  [[nodiscard]] bool decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition,
                            const Motion* known = nullptr);

  /// Gives the same answer where the solution slides on nothing, in a model without nesting, regions and discrete
  /// states. It needs the fields of both sides, f(alpha_surface = 0) and f(alpha_surface = 1), n_x each. Returns
  /// nullopt where it is not as clear. Cost: the gradient of the surface.
  [[nodiscard]] std::optional<switching::SurfaceDecision> decide(const ModeState& before, int surface, double t,
                                                                 const double* x, const std::vector<double>& below,
                                                                 const std::vector<double>& above);
  /// Returns whether decide_by_rows() knows the surface: it is affine, and the system large.
  [[nodiscard]] bool has_rows(int surface) const;
  /// Does the same where f is finite on both sides, but perhaps in rows that hold the selection; `before` is the same
  /// behind it. Cost: few rows of f.
  [[nodiscard]] std::optional<switching::SurfaceDecision> decide_by_rows(ModeState& before, int surface, double t,
                                                                         const double* x);
  /// Returns whether the selection of what was slid on lies within its bounds at an exit, to rounding: away from them
  /// it may have been lost in a two-fold point, where the full decision looks closer.
  [[nodiscard]] static bool is_within_bounds(double alpha) {
    constexpr double rounding = 1e-9;
    return alpha >= -rounding && alpha <= 1.0 + rounding;
  }
  /// Holds a point, and a step of the integrator.
  struct Place {
    double t = 0.0;
    const double* x = nullptr;
    double time_scale = 0.0;
  };
  /// Holds, at an exit, normal components of both fields, and the second derivative of psi along the tangent one, if it
  /// is known.
  struct Motions {
    ExitValues velocities;
    std::optional<double> bend;
  };
  /// Does the same at an exit from sliding on this surface alone, where the field of `side` has become tangent to it;
  /// `before` has the selection of that side. Cost: the gradient, and a second derivative that is not known.
  [[nodiscard]] std::optional<switching::SurfaceDecision> decide_exit(const ModeState& before, int surface,
                                                                      const Place& place, const Motions& motions,
                                                                      Region side);

 private:
  [[nodiscard]] bool moves_no_more_than_rounding(const switching::SurfaceSituation& situation,
                                                 const SwitchingPoint& switching_point) const;
  [[nodiscard]] evaluation::FixedState kept_state(const double* x) const;
  [[nodiscard]] double terms_of(const SwitchingPoint& switching_point) const;
  [[nodiscard]] static bool are_within_bounds(const ModeState& state);
  [[nodiscard]] bool applies(const ModeState& before, const SwitchingPoint& switching_point) const;
  [[nodiscard]] bool by_rows(int surface, const Motion* known) const;
  [[nodiscard]] std::optional<switching::SurfaceDecision> conclude(switching::SurfaceSituation& situation, int surface,
                                                                   int mode, int exit) const;
  void find_velocities(const ModeState& before, const SwitchingPoint& switching_point, const Motion* known,
                       switching::SurfaceSituation& situation);
  [[nodiscard]] double velocity_by_rows(int surface, double t, const double* x, const std::vector<double>& alpha) const;
  void find_tangent_drift(const SwitchingPoint& switching_point, int exit, const Motion* known,
                          switching::SurfaceSituation& situation);
  [[nodiscard]] std::optional<switching::Drift> drift_by_rows(const SwitchingPoint& switching_point, int surface);
  [[nodiscard]] double along_row(const std::vector<double>& f, double rate) const;
  double velocity(const SwitchingPoint& switching_point, int surface, double selection);
  double velocity(double t, const double* x, int surface, const std::vector<double>& alpha,
                  const std::vector<double>& f);
  void fill(const ModeState& before, const SwitchingPoint& switching_point, const switching::SurfaceDecision& decision,
            Transition& transition) const;
  bool complete(const SwitchingPoint& switching_point, const Motion* known, ModeState& state);
  bool select_others(const SwitchingPoint& switching_point, ModeState& state);

  const SwitchingContext& switching_context_;
  std::vector<bool> is_inner_;  ///< n_psi: a switching function is nested around it
  std::vector<int> between_;    ///< functions whose selection outside the mode may lie between 0 and 1
  std::vector<double> alpha_;   ///< n_psi
  std::vector<double> f_, row_;
  double rate_ = 0.0;              ///< d psi/dt, beside row_ = grad psi, where rows of f are looked at
  evaluation::AffineRow lie_row_;  ///< L psi
  ModeField field_;
};

}  // namespace saltus::event_integrator
