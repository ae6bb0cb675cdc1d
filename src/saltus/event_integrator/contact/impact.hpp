// The impulses of an impact.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Of a slip in an impact, relative to the fastest velocity before it: what is below has been brought to rest.
inline constexpr double slip_rounding = 1e-11;

/// Returns the impulses of the contacts that touch, as the limit of stiff contacts (Darboux and Keller): in the place
/// of time stands the normal impulse p,
///
///   dv/dp = M^-1 sum_i lambda_i (n_i - mu_i s_i t_i),   s_i in sign(t_i'v),
///
/// lambda_i = 1 where the contact closes, in [0, 1] where it is held at rest, 0 where it opens; in a plane s_i t_i is
/// the direction of slip, which may turn. It is piecewise linear in p and resolved exactly, but for slips that turn,
/// which are integrated to about twelve digits. Compression ends where no contact closes; then every contact gives back
/// the part e_i^2 of the work that it took (Stronge). One contact without friction has Newton's v+ = -e v-.
///
/// @param touching  contacts whose gap is 0
/// @param pushed    a contact that presses on although nothing closes: an impact without a collision
/// @return r impulses; nothing where the process has no continuation or no end
/// Cost: a dense solve per piece; at most three pieces for one contact with one tangent.
[[nodiscard]] std::optional<linalg::Vector> impact(const ContactPoint& point, const std::vector<int>& touching,
                                                   std::optional<int> pushed = std::nullopt);

}  // namespace saltus::event_integrator
