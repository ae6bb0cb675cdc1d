// The normal components of the fields at a point, as a function of the selections.
#pragma once

#include "saltus/base/function_ref.hpp"

namespace saltus::switching {

/// g_j(alpha) = grad psi_j . f(alpha) + d psi_j/dt of the m surfaces that meet at a point: m selections in, m
/// velocities out. At alpha in {0, 1}^m these are the normal components of the 2^m fields that meet there.
using ProjectedField = FunctionRef<void(const double* alpha, double* g)>;

/// Says how the selections enter g. `multi_affine`: affine in each selection (multilinear interpolation, eq. (2.6) of
/// [guglielmi2022]); `general`: smooth (an Aizerman-Pyatnitskii model), so that derivatives are difference quotients.
enum class Interpolation { multi_affine, general };

}  // namespace saltus::switching
