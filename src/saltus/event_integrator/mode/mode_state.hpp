// Where the engine is: the mode k and the selections that belong to it.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {

struct HigherOrderSet;
using Activities = std::vector<model::Activity>;

/// Holds k in {-1, 0, 1}^n_psi with its selections. "On the surface" is part of the mode, never a floating-point
/// accident.
struct ModeState {
  std::vector<int> mode;      ///< k_j
  std::vector<double> alpha;  ///< 1, 0 for k_j = 1, -1; the last sliding value for k_j = 0
  std::vector<int> sliding;   ///< I = { j : k_j = 0 }, ascending

  /// For one sliding surface: the selections of the two regions that meet there. They differ from `alpha` also in
  /// switching functions nested around the sliding one, whose sign is read in each region.
  std::array<std::vector<double>, 2> corner_alpha;

  /// Of higher-order sliding, null otherwise: what else is held at zero, and which selections mean nothing.
  std::shared_ptr<const HigherOrderSet> higher = {};

  /// Surfaces that guards of jumps at rest keep at zero (RestingSurfaces), ascending: k_j = 0, but nothing slides on
  /// them, and their selections mean nothing.
  std::vector<int> resting = {};

  /// How contacts take part in it. While an instant is resolved they are those of the kernel, which the mode takes over
  /// as it begins.
  Activities activities = {};
};

/// Sets mode, alpha and sliding of one surface.
void set_surface(ModeState& state, int surface, int mode, double alpha);
/// Leaves surfaces to the sides of a corner: above the i-th of them where bit i is set.
void set_to_corner(ModeState& state, const std::vector<int>& surfaces, std::size_t corner);
/// Sets corner_alpha from alpha, on both sides of the first sliding surface and below the others; as it is without
/// nesting.
void set_corner_alpha(ModeState& state);

}  // namespace saltus::event_integrator
