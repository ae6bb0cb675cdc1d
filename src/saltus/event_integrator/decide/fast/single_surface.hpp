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
///   - f is affine in the selection, and both normal components are clear of zero (at an exit the other one, and the
///     second derivative along the tangent field).
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

  /// Holds where a surface is met or left.
  struct Place {
    int surface = 0;
    int exit = 0;  ///< the side to which sliding on it ends, 0 where it is met
    double t = 0.0;
    const double* x = nullptr;
    double time_scale = 0.0;  ///< a step of the integrator
  };
  /// Holds the normal components of the fields of both sides.
  struct Velocities {
    double below = 0.0, above = 0.0;
  };
  /// Gives the same answer where no other surface is slid on, from velocities that are known; nullopt where it is not
  /// as clear. For models without nesting, regions and discrete states.
  /// @param alpha  selections of the mode before, the same behind it
  /// @param mode   of the surface before
  /// @param bend   second derivative of psi along the field that ends the sliding, where it is known
  /// Cost: at an exit the gradient, and a second derivative that is not known.
  [[nodiscard]] std::optional<switching::SurfaceDecision> decide(std::vector<double>& alpha, int mode,
                                                                 const Place& place, const Velocities& velocities,
                                                                 std::optional<double> bend = std::nullopt);
  /// Returns those of two fields, n_x each. Cost: the gradient of the surface.
  [[nodiscard]] Velocities velocities_of(const std::vector<double>& below, const std::vector<double>& above,
                                         const ModeState& before, const Place& place);
  /// Returns whether velocities_by_rows() knows the surface: it is affine, and the system large.
  [[nodiscard]] bool has_rows(int surface) const;
  /// Returns those of fields that are finite, but perhaps in rows that hold the selection; `alpha` is the same behind
  /// it. Cost: few rows of f.
  [[nodiscard]] Velocities velocities_by_rows(std::vector<double>& alpha, const Place& place) const;

 private:
  [[nodiscard]] bool moves_no_more_than_rounding(const Velocities& velocities, const Place& place) const;
  [[nodiscard]] evaluation::FixedState kept_state(const double* x) const;
  [[nodiscard]] double noise(const Place& place) const;
  [[nodiscard]] static bool are_within_bounds(const ModeState& state);
  [[nodiscard]] bool applies(const ModeState& before, const SwitchingPoint& switching_point) const;
  [[nodiscard]] bool by_rows(int surface, const Motion* known) const;
  void find_gradient(const std::vector<double>& alpha, const Place& place);
  [[nodiscard]] Velocities find_velocities(const ModeState& before, const Place& place, const Motion* known);
  [[nodiscard]] double velocity_by_rows(const Place& place, const std::vector<double>& alpha) const;
  [[nodiscard]] bool find_tangent_drift(std::vector<double>& alpha, const Place& place, std::optional<double> bend,
                                        switching::SurfaceSituation& situation);
  [[nodiscard]] std::optional<double> bend_by_rows(const Place& place);
  [[nodiscard]] double along_row(const std::vector<double>& f) const;
  void fill(const ModeState& before, const SwitchingPoint& switching_point, const switching::SurfaceDecision& decision,
            Transition& transition) const;
  bool complete(const SwitchingPoint& switching_point, const Motion* known, ModeState& state);
  bool select_others(const SwitchingPoint& switching_point, ModeState& state);

  const SwitchingContext& switching_context_;
  std::vector<bool> is_inner_;  ///< n_psi: a switching function is nested around it
  std::vector<int> between_;    ///< functions whose selection outside the mode may lie between 0 and 1
  std::vector<double> alpha_;   ///< n_psi
  std::vector<double> f_, row_;
  double rate_ = 0.0;              ///< d psi/dt, beside row_ = grad psi
  evaluation::AffineRow lie_row_;  ///< L psi
  ModeField field_;
};

}  // namespace saltus::event_integrator
