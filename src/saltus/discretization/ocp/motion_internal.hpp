// The motion of given controls on the elements of a problem: where it switches, elements end.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/mode_sequence_internal.hpp"
#include "saltus/discretization/ocp/near_states_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {

/// Goes through the control intervals of a problem, from its start, with its controls.
class Motion {
 public:
  /// @param w     horizon, parameters, initial state with its multipliers, and controls
  /// @param near  the states that the motion stays near; null: none
  Motion(const OcpStructure& made, mpcc::ConstVectorView w, const NearStates* near,
         const std::function<bool()>& is_over)
      : made_(made), states_(made), trial_(made, w), near_(near), is_over_(is_over) {}

  /// Returns the stretches of interval k behind what is left of it, which becomes what is left of the next one; nothing
  /// where no mode goes on, they accumulate, too many have been tried, or time is over.
  /// Cost: some forty elements per switch.
  [[nodiscard]] std::optional<Stretches> interval(std::size_t k, std::vector<double>& left);

 private:
  [[nodiscard]] std::optional<Stretch> step(std::size_t k, const std::vector<double>& left, double rest);
  [[nodiscard]] double passed(const std::vector<double>& left, const Stretch& stretch) const;
  void go_on(std::size_t k, const std::vector<double>& left, double rest, double below, Stretch& stretch) const;

  const OcpStructure& made_;
  SurfaceStates states_;
  ElementTrial trial_;
  const NearStates* near_;
  const std::function<bool()>& is_over_;
  ElementSides::Sides last_{};  ///< modes so far
  int trials_ = 0;              ///< elements of modes that might go on
};

}  // namespace saltus::discretization
