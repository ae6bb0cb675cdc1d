// Where three or more regions by `indicator` meet on a switching surface that influences them.
#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/switching/regions/regions_on_surface.hpp"

namespace saltus::event_integrator {
namespace {

/// Regions that go on together, and the mode of the surface.
struct Continuation {
  switching::RegionSet set;
  GivenMode surface;
};

/// The decision at one point, with the fields of both sides of the surface.
class OnSurface {
 public:
  OnSurface(const SwitchingContext& s, const ModeState& base, const SwitchingPoint& switching_point, int surface,
            const std::vector<int>& candidates)
      : s_(s), base_(base), switching_point_(switching_point), surface_(surface), candidates_(candidates) {}

  std::vector<Continuation> run() {
    const auto here = point_at(switching_point_.t, switching_point_.x);
    for (const int side : {-1, 1}) leave(here, side);
    for (auto& slide : switching::admissible_region_slides(here, marginal_part)) {
      if (slide.regions.margin > marginal_part || goes_on(slide)) {
        found_.push_back({std::move(slide.regions), {surface_, 0, slide.alpha}});
      }
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::vector<double> selections(const switching::RegionSet& set, double alpha) const {
    std::vector<double> all = base_.alpha;
    for (const int region : candidates_) all[at(region)] = 0.0;
    for (std::size_t k = 0; k < set.active.size(); ++k) all[at(candidates_[at(set.active[k])])] = set.weights[k];
    all[at(surface_)] = alpha;
    return all;
  }

  [[nodiscard]] switching::RegionsOnSurface point_at(double t, const double* x) const {
    SwitchingPoint there = switching_point_;
    there.t = t;
    there.x = x;
    const ProjectedFields fields(s_.kernel, there);
    std::vector<int> functions(candidates_.begin() + 1, candidates_.end());
    functions.push_back(surface_);
    const auto n = candidates_.size();
    const auto side = [&](double alpha, switching::RegionRates& rates, std::vector<double>& velocity) {
      rates = {static_cast<int>(n), std::vector<double>(n * n, 0.0)};
      for (std::size_t j = 0; j < n; ++j) {
        const auto velocities = fields.velocities(selections({{static_cast<int>(j)}, {1.0}}, alpha), functions);
        for (std::size_t i = 1; i < n; ++i) rates.rates[i * n + j] = -velocities[i - 1];
        velocity.push_back(velocities.back());
      }
    };
    switching::RegionsOnSurface point;
    side(0.0, point.below, point.velocity_below);
    side(1.0, point.above, point.velocity_above);
    return point;
  }

  /// A little later along a motion that starts with these weights.
  [[nodiscard]] std::vector<double> ahead(const switching::RegionSet& set, double alpha) const {
    std::vector<double> x(switching_point_.x, switching_point_.x + s_.kernel.states()), f(x.size());
    s_.kernel.field(switching_point_.t, switching_point_.x, selections(set, alpha).data(), f.data());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += time() * f[i];
    return x;
  }
  [[nodiscard]] double time() const { return look_ahead(switching_point_.time_scale); }

  static double velocity_of(const std::vector<double>& velocities, const switching::RegionSet& set) {
    double sum = 0.0;
    for (std::size_t k = 0; k < set.active.size(); ++k) sum += velocities[at(set.active[k])] * set.weights[k];
    return sum;
  }

  /// Sets that go on on a side of the surface, and away from it.
  void leave(const switching::RegionsOnSurface& here, int side) {
    const double alpha = side > 0 ? 1.0 : 0.0;
    const auto& velocities = side > 0 ? here.velocity_above : here.velocity_below;
    double scale = 0.0;
    for (const double v : velocities) scale = std::max(scale, std::abs(v));
    for (auto& set : switching::admissible_region_sets(side > 0 ? here.above : here.below, marginal_part)) {
      double velocity = side * velocity_of(velocities, set);
      if (!(velocity >= -marginal_part * scale)) continue;
      if (set.margin <= marginal_part || velocity <= marginal_part * scale) {
        const auto x = ahead(set, alpha);
        const auto later = point_at(switching_point_.t + time(), x.data());
        switching::RegionSet own;
        if (!switching::solve_region_set(side > 0 ? later.above : later.below, set.active, own)) continue;
        if (!(own.margin > 0.0)) continue;
        velocity = side * velocity_of(side > 0 ? later.velocity_above : later.velocity_below, own);
      }
      if (velocity > 0.0) found_.push_back({std::move(set), {surface_, side, alpha}});
    }
  }

  [[nodiscard]] bool goes_on(const switching::RegionSlide& slide) const {
    const auto x = ahead(slide.regions, slide.alpha);
    switching::RegionSlide later;
    return switching::solve_region_slide(point_at(switching_point_.t + time(), x.data()), slide.regions.active,
                                         slide.alpha, later) &&
           later.regions.margin > 0.0;
  }

  const SwitchingContext& s_;
  const ModeState& base_;
  const SwitchingPoint& switching_point_;
  int surface_;
  const std::vector<int>& candidates_;
  std::vector<Continuation> found_;
};

}  // namespace

bool Decider::decide_regions_on(int surface, const evaluation::RegionRange& range, std::vector<int> candidates) {
  const std::string all = names(s_.layout, candidates) + ", " + s_.layout.surfaces[at(surface)].name;
  std::vector<int> together(candidates.begin() + 1, candidates.end());
  together.push_back(surface);
  if (fields_.gradients_depend(base_.alpha, together)) {
    return fail(result::Termination::outside_class,
                fmt::format("at t = {} the regions and the surface {} meet where their gradients depend on each other: "
                            "the selections depend on how wide the layer of the surface is beside theirs, which the "
                            "model does not say; perturb a parameter",
                            switching_point_.t, all));
  }
  auto found = OnSurface(s_, base_, switching_point_, surface, candidates).run();
  if (found.empty()) {
    return fail(result::Termination::no_admissible_mode,
                fmt::format("the regions and the surface {} meet at t = {}, and no set of them continues the solution",
                            all, switching_point_.t));
  }
  const auto rank = [&](const Continuation& c) {
    std::size_t kept = !switching_point_.start && before_.mode[at(surface)] == c.surface.mode ? 1U : 0U;
    for (const int k : c.set.active) {
      if (!switching_point_.start && before_.mode[at(candidates[at(k)])] == 0) ++kept;
    }
    return std::make_tuple(c.set.attracts, kept, c.set.active.size());
  };
  std::stable_sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return rank(a) > rank(b); });
  RegionChoice choice{range, {}, {}, {}};
  for (const auto& continuation : found) {
    std::vector<ActiveRegion> active;
    for (std::size_t k = 0; k < continuation.set.active.size(); ++k) {
      active.push_back({candidates[at(continuation.set.active[k])], std::clamp(continuation.set.weights[k], 0.0, 1.0)});
    }
    choice.sets.push_back(std::move(active));
    choice.surfaces.push_back(continuation.surface);
  }
  std::vector<int> active;
  for (const auto& region : choice.sets.front()) active.push_back(region.region);
  const auto& [chosen, mode, alpha] = choice.surfaces.front();
  choice.reason = fmt::format("{}: {} by Stewart's complementarity system, {}", all, names(s_.layout, active),
                              mode == 0  ? "sliding on the surface"
                              : mode > 0 ? "above the surface"
                                         : "below the surface");
  take({chosen}, {mode}, {std::clamp(alpha, 0.0, 1.0)});
  if (found.size() > 1) transition_.unique = false;
  group_reasons_.push_back(choice.reason);
  region_choices_.push_back(std::move(choice));
  return true;
}

}  // namespace saltus::event_integrator
