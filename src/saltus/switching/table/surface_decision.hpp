// What happens at one switching surface: crossing, sliding, repelled. Pure functions of the projected fields.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace saltus::switching {

/// Names the direction in which psi moves along a field: the sign of its first derivative that does not vanish; `stays`
/// if all derivatives that were looked at vanish.
enum class Drift { down = -1, stays = 0, up = 1 };

/// Says how the solution reached the surface psi = 0.
enum class Arrival {
  from_below,  ///< from psi < 0
  from_above,  ///< from psi > 0
  along,       ///< it was sliding on it
  at_start,    ///< it starts there
};

/// Holds one surface with every other selection held: normal components of the fields that meet there,
///   below.velocity = grad psi . f(alpha = 0) + d psi/dt   (valid where psi < 0),   above: alpha = 1.
/// Unit: unit of psi per unit of time.
struct Side {
  double velocity = 0.0;
  Drift drift = Drift::stays;
};
struct SurfaceSituation {
  Side below, above;
  Arrival arrival = Arrival::at_start;
};

enum class Verdict {
  decided,
  stands,    ///< neither field leaves the surface: psi stays 0 whatever the selection
  two_fold,  ///< both fields are tangent: the sliding selection is not determined
  coupled,   ///< several surfaces influence each other: needs the codimension-2 decision
};

struct SurfaceDecision {
  Verdict verdict = Verdict::decided;
  int mode = 0;                  ///< -1, 0 (sliding), +1
  double alpha = 0.0;            ///< selection behind the event: 0, 1, or the sliding value
  std::vector<int> other_modes;  ///< further continuations in the sense of Filippov; empty = unique
  std::string_view reason;       ///< which rule decided, in words; of static duration
};

/// Returns the sliding selection alpha = g- / (g- - g+) from g- = below.velocity >= 0 >= g+ = above.velocity, not both
/// 0 (eq. (4.2) of [guglielmi2022] with lambda = 2 alpha - 1). Adds two numbers of the same sign: no cancellation.
[[nodiscard]] double sliding_alpha(double velocity_below, double velocity_above);

/// Decides one surface ([guglielmi2022], Figs. 2 and 3, completed by tangencies and starts).
///   below up,   above up    -> psi > 0          below down, above down -> psi < 0
///   below up,   above down  -> sliding          below down, above up   -> repelling: psi > 0, not unique
/// `stays` on one side: that field moves along the surface; see the table in the source.
/// @return a decision, or a verdict that says what is not determined.
[[nodiscard]] SurfaceDecision decide_surface(const SurfaceSituation& situation);

}  // namespace saltus::switching
