// The usual meeting of two surfaces that influence each other, decided without detours.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/field/field_memory.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/switching/plane/intersection.hpp"

namespace saltus::event_integrator {

/// Decides what decide_mode() decides, with the same bits, where
///   - two surfaces that influence each other are at zero, and nothing else: one is met while the solution slides on
///     the other, or both are met at once,
///   - no function is nested around another one, there are no regions by indicator, and f is affine in the selections,
///   - all normal components of the four fields are clear of zero, and a tree knows the only continuation.
/// Cost: four evaluations of f, a tree, and one evaluation of the new mode's field where it slides. Owns its work
/// space.
class SurfacePair {
 public:
  explicit SurfacePair(const SwitchingContext& switching_context);

  /// Fills `transition`, whose storage is used again.
  /// @return whether the switching point is of this kind; if not, `transition` is in no particular state.
  [[nodiscard]] bool decide(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition);
  /// Does the same in two parts, so that what lies between can be asked. The first part tells whether the switching
  /// point is of this kind, as far as the fields tell.
  /// @param field  of the mode before, behind an evaluation at the switching point, where it slides on one
  ///               surface; nullptr if it is not known
  /// Cost: four evaluations of f, two with a field.
  [[nodiscard]] bool look(const ModeState& before, const SwitchingPoint& switching_point, const ModeField* field);
  /// Returns, behind it, on what the solution goes on sliding across the other surface (switching::pass_across());
  /// nullopt where it does not, or not as clearly.
  [[nodiscard]] std::optional<SlidAcross> across(const ModeState& before, const SwitchingPoint& switching_point) const;
  /// Does the second part: makes the transition, by a tree.
  [[nodiscard]] bool conclude(const ModeState& before, const SwitchingPoint& switching_point, Transition& transition);

 private:
  [[nodiscard]] bool applies(const ModeState& before, const SwitchingPoint& switching_point) const;
  [[nodiscard]] Meeting meeting(const ModeState& before, const SwitchingPoint& switching_point) const;
  bool find_normals(const SwitchingPoint& switching_point);
  [[nodiscard]] bool project(const std::vector<double>& f, std::array<double, 2>& velocities) const;
  /// Of the four corners, n_x each; nullptr where they are not known.
  using KnownFields = std::array<const std::vector<double>*, 4>;
  bool find_table(const SwitchingPoint& switching_point, const KnownFields& known);
  bool moves_there(const SwitchingPoint& switching_point, ModeState& state);
  bool slides_on_both(const SwitchingPoint& switching_point, ModeState& state);

  const SwitchingContext& switching_context_;
  bool any_ = false;                     ///< the system may have such meetings
  std::vector<double> alpha_;            ///< n_psi
  std::vector<double> f_;                ///< n_x
  std::vector<double> rows_[2];          ///< gradients of the two surfaces
  std::vector<std::size_t> columns_[2];  ///< nonzero ones of these
  std::array<double, 2> rates_{};
  std::array<int, 2> constant_rows_{-1, -1};  ///< the surfaces of these, if they are the same everywhere
  std::array<double, 2> scales_{};            ///< largest normal components
  std::array<std::array<double, 4>, 2> velocities_{};
  FieldMemory corners_;  ///< of the four regions that meet
  ModeField field_;
};

}  // namespace saltus::event_integrator
