// How a mode becomes the next one.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/switching/plane/intersection.hpp"

namespace saltus::event_integrator {

struct Transition;

/// Holds two surfaces that influence each other, at zero together.
struct Meeting {
  std::array<int, 2> surfaces{};
  std::array<std::array<double, 4>, 2> velocities{};  ///< normal components of the corner fields, bit i: alpha_i
  std::optional<std::array<double, 2>> alpha;         ///< of the mode before; nullopt at a start
};

/// Holds the surface that is slid on before and behind a switch of another one; the two influence each other.
struct SlidAcross {
  int surface = -1;
  double alpha_before = 0.0, alpha_after = 0.0;
  switching::Leaf leaf = switching::Leaf::none;
  Meeting meeting = {};
};

/// ModeChange says how the mode of a run becomes the next one; the parts that know the mode begin that one from it.
/// Usually one listed surface changes, and perhaps the selection of what is slid on across it. In a model without
/// nested functions, regions by indicator, cells and jumps parts then change what they have. Any other mode they begin
/// anew.
struct ModeChange {
  int surface = -1;  ///< the only one whose mode changes; -1: all of the mode may be another one
  int before = 0, after = 0;
  double alpha_before = 0.0, alpha_after = 0.0;
  std::string_view reason = {};  ///< a literal
  const SlidAcross* slid = nullptr;
  /// Constants of the regions beyond the surface, where they are known: of one, or of both beside what is slid on.
  std::array<const evaluation::FieldConstants*, 2> beyond{};
  bool is_evaluated = false;  ///< the mode behind begins at the same point, with the slope that the position has

  const ModeState* mode_before = nullptr;  ///< where all of it may change, like the following
  const ModeState* mode_after = nullptr;
  const std::vector<int>* zero_order = nullptr;  ///< Transition::zero_order
  const Transition* transition = nullptr;        ///< that has led to it

  [[nodiscard]] bool is_single() const { return surface >= 0; }
  /// Returns whether the only surface is crossed.
  [[nodiscard]] bool crosses() const { return before != 0 && after != 0; }
  /// Returns the order in t of the zero of the only surface along the new field; 0 while it is slid on.
  [[nodiscard]] int order() const { return after == 0 ? 0 : before == 0 ? 2 : 1; }
};

/// Makes of a mode the one behind a change.
void apply(const ModeChange& change, ModeState& state);

}  // namespace saltus::event_integrator
