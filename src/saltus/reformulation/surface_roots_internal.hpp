// Powers with exponents below 1 of what is zero on a surface: sqrt(|x|) sign(x) and its like.
#pragma once

#include "saltus/model/system.hpp"
#include "saltus/reformulation/unnesting_internal.hpp"

namespace saltus::reformulation {

/// Takes powers of multiples of psi_j out of branches that count on one side of surface j only (their weight is 0 for
/// alpha_j = 0, or for 1): base^c with base > 0 on that side, c no integer. They become odd functions of the base, as
/// elements that end at the surface look beyond it. While the solution slides on it they are 0, whatever the rounding
/// of psi: f holds a symbol for that, see with_roots(). Those with c < 1 have an infinite derivative at the surface and
/// go to Unnested::roots, with a symbol for their value. Cost: linear in the size of f, times surfaces inside guards.
void take_roots(const model::System& system, Unnested& unnested);

/// Makes the parts of a Dcs that are made of them: f, with_roots, roots, root_bases, root_exponents.
void finish_roots(const Unnested& unnested, Dcs& dcs);

}  // namespace saltus::reformulation
