#include "saltus/event_integrator/sequences/switch_accumulation.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/event_integrator/mode/mode_differences_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

using Reason = StepTolerances::Reason;

SwitchAccumulation::SwitchAccumulation(const SwitchingContext& switching_context, const Position& here, double span,
                                       StepTolerances& tolerances)
    : switching_context_(switching_context),
      kernel_(switching_context.kernel),
      here_(here),
      tolerances_(tolerances),
      rates_(kernel_, here),
      series_(span),
      shortest_(3 * switching_context.layout.surfaces.size(), 0.0),
      slope_(here.x.size()) {}

void SwitchAccumulation::note(const ModeChange& change) {
  if (!series_.tightens()) return cycles_.clear();
  if (change.is_single()) {
    labels_.assign(1, label_of(change.surface, change.after));
    slid_.assign(1, change.before == 0);
  } else if (!find_labels(*change.mode_before)) {
    return cycles_.clear();
  }
  cycles_.add(here_.t, labels_, here_.x);
  // A limit asks for the rates of those switches only behind which cycles have contracted twice.
  if (!cycles_.shrinks()) return;
  if (!change.is_single()) return note_rates(change.mode_before->alpha);
  alpha_ = here_.state.alpha;
  alpha_[at(change.surface)] = change.alpha_before;
  if (change.slid != nullptr) alpha_[at(change.slid->surface)] = change.slid->alpha_before;
  note_rates(alpha_);
}

/// Of all surfaces whose mode changes, but for kinks, which hold no solution: those that switch with others are none of
/// the sequence. False where nothing else does, or a time.
bool SwitchAccumulation::find_labels(const ModeState& before) {
  labels_.clear();
  slid_.clear();
  bool holds = true;
  for_each_difference(before.mode, here_.state.mode, [&](std::size_t j) {
    const auto role = switching_context_.layout.surfaces[j].role;
    if (role == model::SwitchingRole::kink) return;
    holds = holds && (role == model::SwitchingRole::listed || role == model::SwitchingRole::region);
    labels_.push_back(label_of(static_cast<int>(j), here_.state.mode[j]));
    slid_.push_back(before.mode[j] == 0);
  });
  return holds && !labels_.empty();
}

/// How short cycles of the last switch may get.
void SwitchAccumulation::note_rates(const std::vector<double>& alpha_before) {
  kernel_.field(here_.t, here_.x.data(), alpha_before.data(), slope_.data());
  for (std::size_t k = 0; k < labels_.size(); ++k) {
    const int label = labels_[k];
    // Where sliding begins or ends psi moves on the other side only.
    const Rate arriving = rates_.along(surface_of(label), slope_);
    const Rate leaving = rates_.here(surface_of(label));
    const double rate = std::max(std::abs(arriving.value), std::abs(leaving.value));
    // As for guards of jumps: between two zeros psi gets about as far as its rate times a quarter of the cycle.
    // Shallower cycles are lost in the rounding of psi, or in ten times the atol that follows the cycles. They are not
    // lost in rtol times the terms of psi, as every switch puts psi back to 0. Cycles are far shorter than the steps
    // that rtol allows, and over them the error of a step is far smaller than that.
    const double unresolved =
        std::max(200.0 * rounding_of(leaving.magnitude), 10.0 * tolerances_.step().atol * leaving.slope);
    double& shortest = shortest_[at(label)];
    shortest = rate > 0.0 ? 4.0 * unresolved / rate : 0.0;
    // Where sliding ends psi leaves tangentially: its rate is rounding, and what bends it is what resolves the cycle.
    if (!slid_[k]) continue;
    const double bend =
        std::abs(kernel_.lie_derivative(surface_of(label), 2, here_.t, here_.x.data(), here_.state.alpha.data()));
    if (bend > 0.0) shortest = std::min(shortest, std::sqrt(8.0 * unresolved / bend));
  }
}

void SwitchAccumulation::limit_tolerances(Roots roots) {
  if (cycles_.empty()) {
    first_ = 0.0;
    if (tolerances_.part(Reason::cycles).atol != 1.0 || roots == Roots::ending) {
      tolerances_.lift(Reason::cycles);
      tolerances_.lift(Reason::zeros);
    }
    return;
  }
  const auto cycle = cycles_.closed_cycle();
  if (!cycle) return;
  if (first_ == 0.0) first_ = *cycle;
  closed_ = *cycle;
  constexpr double least = 1e-6;
  const double share = std::clamp(*cycle / first_, least, 1.0);
  tolerances_.limit(Reason::cycles, {.rtol = 1.0, .atol = share * share});
}

void SwitchAccumulation::end_if_over(Roots roots) {
  constexpr double many = 16.0;
  if (tolerances_.part(Reason::cycles).atol == 1.0 || here_.t - series_.last() <= many * closed_) return;
  cycles_.clear();
  limit_tolerances(roots);
}

std::optional<SeriesLimit> SwitchAccumulation::dense_limit() const {
  const auto cycle = cycles_.last_cycle();
  if (!cycle) return std::nullopt;
  // Cycles that are not longer than this are extrapolated whatever remains.
  return cycles_.limit(std::vector<double>(shortest_.size(), 2.0 * *cycle));
}

std::optional<SeriesLimit> SwitchAccumulation::unresolved(int surface, int mode, double duration) const {
  const double shortest = std::max(shortest_[at(label_of(surface, -1))], shortest_[at(label_of(surface, 1))]);
  if (empty() || !(duration <= shortest)) return std::nullopt;
  return SeriesLimit{here_.t, here_.x, {label_of(surface, mode)}, duration};
}

bool SwitchAccumulation::limits_repeat(double t) {
  constexpr int many = 8;
  constexpr double at_once = 1e-3;
  auto& row = limits_in_a_row_;
  const bool follows = row.count > 0 && t - row.last <= at_once * row.first_cycle;
  row = {follows ? row.count + 1 : 1, t, follows ? row.first_cycle : first_};
  return row.count >= many;
}

}  // namespace saltus::event_integrator
