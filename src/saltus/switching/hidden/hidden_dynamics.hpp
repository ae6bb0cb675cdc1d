// What happens where any number of surfaces that influence each other are met: the limit of the regularised system.
#pragma once

#include <string_view>
#include <vector>

#include "saltus/switching/table/group_decision.hpp"
#include "saltus/switching/table/projected_field.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::switching {

/// Says how the solution got to the surfaces.
struct HiddenSituation {
  std::vector<Arrival> arrival;  ///< m
  std::vector<double> alpha;     ///< m; read where the arrival is `along`: the selection with which it slid so far
};

struct HiddenOptions {
  /// Multiplies the default speeds kappa_j = 1 / max |g_j| over the corners; m positive numbers, empty = ones.
  std::vector<double> scaling;
  Interpolation interpolation = Interpolation::multi_affine;
  int budget = 100000;  ///< Runge-Kutta steps and changes of zone per trajectory before it is given up
};

/// Says how a trajectory of the hidden dynamics ends.
enum class HiddenLimit {
  settled,      ///< every surface is left for good, or its selection has a stable limit
  oscillating,  ///< recurrent: the solution slides, the regularised solution oscillates about it
  rootless,     ///< recurrent, about no root: the solution slides along a mean of the fields that no selections give
  spirals_out,  ///< all of space is visited with growing amplitude
  undecided,    ///< none of it within the budget, velocities that are not finite, or rest everywhere
};

struct HiddenDecision {
  HiddenLimit limit = HiddenLimit::undecided;
  std::vector<int> mode;      ///< m: -1, 0 (sliding), +1; meaningless behind `oscillating`
  std::vector<double> alpha;  ///< m: 0, 1, or the sliding selection (oscillating: the root that is enclosed)
  /// The outcome hangs on details that the limit forgets: trajectories started a little differently, or at another time
  /// behind the event, end elsewhere.
  bool structurally_unstable = false;
  std::vector<std::vector<int>> other_modes;  ///< where those end
  std::string_view reason;                    ///< in words, of static duration
  long evaluations = 0;                       ///< of g or of its table
};

/// Decides m surfaces by following the hidden dynamics u_j' = kappa_j g_j(pi(u)), pi(u) = min(max(u, 0), 1), eq. (2.8)
/// of [guglielmi2022], to its limit set.
///
/// Start: u_j = 0 or 1 on the side of arrival; u_j = alpha_j while sliding. Several arrivals at once are unfolded in
/// every order, one surface ahead of the rest. A start on the surfaces is tried from the corners (the one with all
/// selections 1 decides, as on one surface). Where these disagree the decision is structurally unstable.
///
/// Surfaces that do not depend on each other, which differences of g tell, are decided group by group: the cost is
/// 2^(largest group), not 2^m. Exact where at most one selection varies, Dormand-Prince 5(4) or Radau IIA elsewhere.
/// @param g  the velocities at the point; evaluated in [0, 1]^m, a little outside for groups of more than eight
/// Cost: a few hundred to a few thousand evaluations; some 20 microseconds for two surfaces. Allocates.
[[nodiscard]] HiddenDecision decide_by_hidden_dynamics(int surfaces, ProjectedField g, const HiddenSituation& situation,
                                                       const HiddenOptions& options = {});
[[nodiscard]] HiddenDecision decide_by_hidden_dynamics(const CornerTable& table, const HiddenSituation& situation,
                                                       const HiddenOptions& options = {});

/// Decides where sliding that was determined by its selections ends. At the event itself the hidden dynamics rests at
/// the degenerate root. So it is started there with the fields a little later, g + eta dg/dt, and again with eta / 100.
/// Where the root is still there, but no longer stable, it is left in several directions.
/// @param rate  dg/dt along the sliding field for selections held, same shape as g
/// @param eta   a short time: 1e-6 to 1e-4 of the time scale on which g changes
[[nodiscard]] HiddenDecision decide_leaving(int surfaces, ProjectedField g, ProjectedField rate,
                                            const HiddenSituation& situation, double eta,
                                            const HiddenOptions& options = {});

}  // namespace saltus::switching
