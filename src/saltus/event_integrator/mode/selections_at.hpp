// Selections as they are read at a point.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::event_integrator {

/// Returns the selections read pointwise at (t, x), inner functions first; those at zero keep what they have in
/// `alpha`, functions of discrete states have what is written.
/// @param zeros  event functions that are at zero whatever is left of their value
[[nodiscard]] std::vector<double> selections_at(const evaluation::ModelKernel& kernel, double t, const double* x,
                                                std::vector<double> alpha, const std::vector<int>& zeros = {});

}  // namespace saltus::event_integrator
