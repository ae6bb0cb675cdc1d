// Whether an impact of several contacts has one end, whoever has integrated it.
#pragma once

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// Returns whether an impact of several contacts may end elsewhere than it does. Its end is compared with the limit of
/// stiff contacts, dv/dp = M^-1 sum_i lambda_i (n_i - mu_i s_i t_i) over all that touch. That is compared with impacts
/// of one contact behind the other.
/// @param kernel  of a system with contacts
/// @param event   an impact, with the states of a result
/// Cost: that of the impacts in all orders of up to three contacts.
[[nodiscard]] bool may_end_elsewhere(const evaluation::ModelKernel& kernel, const result::Event& event);

}  // namespace saltus::event_integrator
