// Regions by `indicator` that meet where their indicators depend on each other, as four quadrants do.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/switching/regions/region_spiral.hpp"

namespace saltus::event_integrator {
namespace {

using linalg::Index;
using linalg::Matrix;

/// psi' of all candidates but the reference along the field of each, as a matrix.
Matrix velocities_of(const switching::RegionRates& rates) {
  const Index n = rates.regions;
  Matrix velocities(n - 1, n);
  for (Index i = 1; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      velocities(i - 1, j) = -rates.rate(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    }
  }
  return velocities;
}

}  // namespace

/// grad psi of all candidates but the reference.
Matrix Decider::region_gradients(const std::vector<int>& candidates, double t, const double* x) {
  const auto n = at(s_.kernel.states());
  Matrix rows(static_cast<Index>(candidates.size()) - 1, static_cast<Index>(n));
  std::vector<double> row(n);
  for (std::size_t k = 1; k < candidates.size(); ++k) {
    double rate = 0.0;
    s_.kernel.gradient(candidates[k], t, x, base_.alpha.data(), row.data(), &rate);
    rows.row(static_cast<Index>(k) - 1) = linalg::ConstView(row.data(), static_cast<Index>(n));
  }
  return rows;
}

/// Indicators whose gradients depend on each other, but not their explicit rates, do not stay equal: the sets of those
/// that do are found as if they were independent.
MeetingRegions Decider::meeting_of(std::vector<int> candidates) {
  MeetingRegions meeting{std::move(candidates), std::nullopt};
  const Matrix rows = region_gradients(meeting.candidates, switching_point_.t, switching_point_.x);
  if (!rows.all_finite()) return meeting;
  RegionBasis basis = basis_of(rows);
  if (basis.spans_all(rows.rows()) || basis.base.empty()) return meeting;
  const Matrix velocities = velocities_of(region_rates(meeting.candidates, switching_point_.t, switching_point_.x));
  const Matrix followed = coordinates_in(basis, rows).bottom_rows(rows.rows()) * velocities.selected_rows(basis.base);
  constexpr double same = 1e-6;  // as for gradients
  if ((velocities - followed).max_abs() <= same * velocities.max_abs()) {
    meeting.basis = std::move(basis);
  }
  return meeting;
}

switching::RegionTie Decider::tie_at(const MeetingRegions& meeting, double t, const double* x) {
  const auto& basis = *meeting.basis;
  auto polytope = switching::RegionPolytope::make(coordinates_in(basis, region_gradients(meeting.candidates, t, x)));
  const Matrix velocities = velocities_of(region_rates(meeting.candidates, t, x));
  return {std::move(*polytope), velocities.selected_rows(basis.base)};
}

/// Whether the regions of a set depend on each other a little later along its motion, too: elsewhere a point at which
/// they happen to do so is left at once by some of them.
bool Decider::stays_tied(const MeetingRegions& meeting, const switching::RegionSet& set) {
  std::vector<int> regions;
  for (const int k : set.active) regions.push_back(meeting.candidates[at(k)]);
  if (regions.size() < 3) return true;
  const auto basis = basis_of(region_gradients(regions, switching_point_.t, switching_point_.x));
  if (basis.spans_all(static_cast<Index>(regions.size()) - 1)) return true;
  std::vector<double> ahead;
  step_ahead(meeting, set, ahead);
  const double t = switching_point_.t + look_ahead(switching_point_.time_scale);
  for (int pass = 0; pass < 2; ++pass) {
    for (const Index k : meeting.basis->base) {
      move_onto(s_.kernel, base_, meeting.candidates[static_cast<std::size_t>(k) + 1], t, ahead);
    }
  }
  // A hundredth of a step ahead what depends by chance is independent by about that much; what always depends is so
  // but for the error of the point, its cube.
  constexpr double lasting = 1e-4;
  return remainder(basis, region_gradients(regions, t, ahead.data())) <= lasting;
}

/// Whether these are the weights of before, which lose their stability here, or cease to exist with those of the root
/// that they coalesce with.
bool Decider::is_lost(const MeetingRegions& meeting, const switching::RegionSet& set) {
  const auto is_lost = [&](int j) {
    return contains(switching_point_.coalesced, j) || contains(switching_point_.destabilised, j);
  };
  if (std::none_of(meeting.candidates.begin(), meeting.candidates.end(), is_lost)) return false;
  std::vector<double> change;
  for (const int j : meeting.candidates) change.push_back(before_.mode[at(j)] == 0 ? before_.alpha[at(j)] : 0.0);
  for (std::size_t k = 0; k < set.active.size(); ++k) change[at(set.active[k])] -= set.weights[k];
  // A double root is located to the root of a rounding; other roots are at a distance of the order of one.
  constexpr double near = 1e-4;
  return std::all_of(change.begin(), change.end(), [](double c) { return std::abs(c) <= near; });
}

/// No set goes on where the fields of all regions turn around the point: a cycle that grows leaves it.
bool Decider::spiral_out(const MeetingRegions& meeting, const evaluation::RegionRange& range) {
  if (!meeting.basis || meeting.basis->base.size() != 2) return false;
  const auto cycle = switching::region_spiral(tie_at(meeting, switching_point_.t, switching_point_.x));
  if (!cycle || !(cycle->cycle_ratio > 1.0)) return false;
  const auto& candidates = meeting.candidates;
  // As around an intersection of two surfaces.
  double delta = 1e-6 * switching_point_.time_scale / cycle->duration();
  for (std::size_t k = 1; k < candidates.size(); ++k) {
    delta = std::max(delta, 1e5 * fields_.noise(candidates[k]) / (cycle->cycle_ratio - 1.0));
  }
  const int first = candidates[at(cycle->regions.front())], last = candidates[at(cycle->regions.back())];
  SpiralStart start{delta * cycle->duration(),
                    {switching_point_.x, switching_point_.x + s_.kernel.states()},
                    last,
                    cycle->cycle_ratio};
  std::vector<double> f(start.x.size());
  for (std::size_t k = 0; k < cycle->regions.size(); ++k) {
    std::vector<double> alpha = base_.alpha;
    for (const int region : candidates) alpha[at(region)] = 0.0;
    alpha[at(candidates[at(cycle->regions[k])])] = 1.0;
    s_.kernel.field(switching_point_.t, switching_point_.x, alpha.data(), f.data());
    for (std::size_t i = 0; i < f.size(); ++i) start.x[i] += delta * cycle->durations[k] * f[i];
  }
  transition_.beyond_spiral = std::move(start);
  transition_.unique = false;
  RegionChoice choice{range, {{{first, 1.0}}}, {}};
  choice.reason = fmt::format("{}: no set of them goes on, the solution spirals out", names(s_.layout, candidates));
  group_reasons_.push_back(choice.reason);
  region_choices_.push_back(std::move(choice));
  return true;
}

/// Whether all weights that keep the indicators of a set equal move the solution alike.
bool Decider::moves_in_one_way(const MeetingRegions& meeting, const switching::RegionSet& set) {
  Matrix fields(s_.kernel.states(), static_cast<Index>(meeting.candidates.size()));
  std::vector<double> f(at(s_.kernel.states()));
  for (std::size_t k = 0; k < meeting.candidates.size(); ++k) {
    std::vector<double> alpha = base_.alpha;
    for (const int region : meeting.candidates) alpha[at(region)] = 0.0;
    alpha[at(meeting.candidates[k])] = 1.0;
    s_.kernel.field(switching_point_.t, switching_point_.x, alpha.data(), f.data());
    fields.col(static_cast<Index>(k)) = linalg::ConstView(f.data(), fields.rows());
  }
  return !switching::motion_depends_on_weights(tie_at(meeting, switching_point_.t, switching_point_.x), set, fields);
}

}  // namespace saltus::event_integrator
