#include <IpAlgTypes.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <algorithm>
#include <utility>

#include "saltus/adapters/ipopt/barrier_update_internal.hpp"

namespace saltus::adapters {
namespace {

/// A barrier problem is solved where its scaled error is below this times mu, as in Ipopt's own monotone strategy.
constexpr double solved_to = 10.0;
/// How much of the way to its bounds a step may go, at least.
constexpr double least_fraction = 0.99;

}  // namespace

BarrierUpdate::BarrierUpdate(Ipopt::SmartPtr<Ipopt::LineSearch> line_search, BarrierLoop& loop)
    : line_search_(std::move(line_search)), loop_(loop) {}

bool BarrierUpdate::InitializeImpl(const Ipopt::OptionsList& /*options*/, const std::string& /*prefix*/) {
  set_mu(loop_.first_mu);
  return true;
}

void BarrierUpdate::set_mu(double mu) {
  IpData().Set_mu(mu);
  IpData().Set_tau(std::max(least_fraction, 1.0 - mu));
}

void BarrierUpdate::renew_iterate() {
  Ipopt::SmartPtr<Ipopt::IteratesVector> same = IpData().curr()->MakeNewIteratesVectorCopy();
  IpData().set_trial(same);
  IpData().AcceptTrialPoint();
  IpData().Set_W(IpCq().curr_exact_hessian());
}

bool BarrierUpdate::UpdateBarrierParameter() {
  bool is_tiny = IpData().tiny_step_flag();
  IpData().Set_tiny_step_flag(false);
  bool is_asked = false;
  while (is_tiny || IpCq().curr_barrier_error() <= solved_to * IpData().curr_mu()) {
    loop_.program.take_iterate(&IpData(), &IpCq());
    const auto next = loop_.next(loop_.program.point(), IpData().curr_mu(), IpData().iter_count());
    loop_.is_ended = !next;
    if (!next) THROW_EXCEPTION(Ipopt::TINY_STEP_DETECTED, "the loop has been ended");
    set_mu(next->mu);
    if (next->is_changed) renew_iterate();
    is_asked = true;
    is_tiny = false;
  }
  if (is_asked) line_search_->Reset();
  return true;
}

}  // namespace saltus::adapters
