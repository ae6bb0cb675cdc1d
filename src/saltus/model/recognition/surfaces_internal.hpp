// What happens on the surfaces psi_j = 0, found out at seeded points on them: kinks, and where the two inclusions
// differ.
#pragma once

#include <vector>

#include "saltus/model/graph/tape_internal.hpp"
#include "saltus/model/recognition/surface_points_internal.hpp"
#include "saltus/model/recognition/surface_profile_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

struct SurfaceClass {
  SwitchingRole role = SwitchingRole::listed;
  bool jumps = true;  ///< something jumps on it
};

/// Finds which surfaces are kinks, which depend on time only, and which make something jump.
///
/// Everything that can jump is in `targets`, the other psi among them. The targets that contain alpha_j are evaluated
/// at up to 64 points on psi_j = 0, around the initial state and far from it. There alpha_j is 0 and 1, and the other
/// alphas are the signs; a difference beyond rounding and 1e-9 of the difference a step away from the surface is a
/// jump. A surface without jump is a kink; one on which no point is found counts as listed. Discrete states are points
/// like others; a psi of nothing else is discrete whether something jumps or not. Where no such point shows a jump,
/// points are moved to where conditions hold that would show one, discrete ones (n == 2) at equality, too.
/// @param surfaces  in the order of their alphas
/// @param discrete  the discrete functions, and their selections where they are 0
/// @return one class per surface
[[nodiscard]] std::vector<SurfaceClass> classify(const Tape& tape, const std::vector<Surface>& surfaces,
                                                 const Selections& discrete, const std::vector<int>& targets);

/// Returns whether the value of `target` on psi_j = 0 at alpha_j = 1/2 is other than the mean of those at 0 and 1.
[[nodiscard]] bool bends_on_surface(const Tape& tape, const Surface& surface, const Selections& discrete, int target);

}  // namespace saltus::model
