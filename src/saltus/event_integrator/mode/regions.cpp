#include "saltus/event_integrator/mode/regions.hpp"

#include <algorithm>

#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

using evaluation::ModelKernel;
using evaluation::RegionRange;

int reference_of(const ModeState& state, const RegionRange& group) {
  if (state.mode.empty()) return -1;
  for (int j = group.first; j < group.first + group.count; ++j) {
    const bool slides = std::binary_search(state.sliding.begin(), state.sliding.end(), j);
    if (state.mode[at(j)] == 0 && !slides) return j;
  }
  return -1;
}

void set_references(ModelKernel& kernel, const ModeState& state) {
  const auto& groups = kernel.region_groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (const int reference = reference_of(state, groups[g]); reference >= 0) kernel.set_reference(g, reference);
  }
}

namespace {

/// The mode of a reference: active, but on no surface.
void make_reference(ModeState& state, int region, double weight) {
  set_surface(state, region, 1, weight);
  state.mode[at(region)] = 0;
}

}  // namespace

void set_active(ModeState& state, const RegionRange& group, const std::vector<ActiveRegion>& active) {
  for (int j = group.first; j < group.first + group.count; ++j) set_surface(state, j, -1, 0.0);
  for (const auto& [region, weight] : active) set_surface(state, region, 0, weight);
  make_reference(state, active.front().region, active.front().weight);
}

void rebase(const ModelKernel& kernel, ModeState& state, std::vector<int>& zero_order) {
  for (const auto& group : kernel.region_groups()) {
    for (int j = group.first; j < group.first + group.count; ++j) {
      if (state.mode[at(j)] != 1) continue;
      const int old = reference_of(state, group);
      if (old >= 0) set_surface(state, old, -1, 0.0);
      make_reference(state, j, 1.0);
      if (old >= 0) std::swap(zero_order[at(old)], zero_order[at(j)]);
      break;
    }
  }
}

void complete_weights(const ModelKernel& kernel, ModeState& state) {
  for (const auto& group : kernel.region_groups()) {
    const int reference = reference_of(state, group);
    if (reference < 0) continue;
    for (auto* alpha : {&state.alpha, &state.corner_alpha[0], &state.corner_alpha[1]}) {
      if (alpha->empty()) continue;
      double weight = 1.0;
      for (int j = group.first; j < group.first + group.count; ++j) weight -= j == reference ? 0.0 : (*alpha)[at(j)];
      (*alpha)[at(reference)] = weight;
    }
  }
}

bool same_group(const ModelKernel& kernel, int i, int j) {
  const auto& groups = kernel.region_groups();
  return std::any_of(groups.begin(), groups.end(), [&](const auto& group) { return group.holds(i) && group.holds(j); });
}

ReferenceScope::ReferenceScope(ModelKernel& kernel, const ModeState& state) : kernel_(kernel) {
  for (std::size_t g = 0; g < kernel.region_groups().size(); ++g) before_.push_back(kernel.reference(g));
  set_references(kernel, state);
}

ReferenceScope::~ReferenceScope() {
  for (std::size_t g = 0; g < before_.size(); ++g) {
    if (before_[g] >= 0) kernel_.set_reference(g, before_[g]);
  }
}

}  // namespace saltus::event_integrator
