// The motion of given controls on the elements of a problem: where it switches, elements end.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {

/// Holds a piece of a motion in one mode, in an interval.
struct MotionPiece {
  ElementSides::Sides modes;
  double length = 0.0;  ///< in parts of a control interval
  bool stands = false;  ///< time stands still
};

/// Goes through the control intervals of a problem, from its start, with its controls, in as few elements as there are
/// modes.
class Motion {
 public:
  /// @param w  horizon, parameters, initial state with its multipliers, and controls
  Motion(const OcpStructure& made, mpcc::ConstVectorView w) : made_(made), states_(made), trial_(made, w) {}

  /// Returns the pieces of interval k behind what is left of it, which becomes what is left of the next one; nothing
  /// where no mode goes on, or there are more of them than elements.
  /// Cost: some forty elements per switch.
  [[nodiscard]] std::optional<std::vector<MotionPiece>> interval(std::size_t k, std::vector<double>& left);

 private:
  struct Step {
    MotionPiece piece;
    linalg::Vector own;
  };
  [[nodiscard]] std::optional<Step> step(std::size_t k, const std::vector<double>& left, double rest) const;
  [[nodiscard]] std::vector<ElementSides::Sides> candidates(const std::vector<double>& lambda) const;
  void go_on(std::size_t k, const std::vector<double>& left, double rest, Step& step) const;

  const OcpStructure& made_;
  SurfaceStates states_;
  ElementTrial trial_;
  ElementSides::Sides last_{};  ///< modes so far
};

/// Gives all elements the motion of the controls at w, and its modes.
/// @return false where it has none: an interval has fewer elements than modes, their lengths are fixed, or no mode goes
/// on
[[nodiscard]] bool realise(const OcpStructure& made, linalg::Vector& w, ElementSides::Sides& sides);

}  // namespace saltus::discretization
