// Groups of modes by `indicator` in the engine: which regions are active, and against which one they are measured.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Returns the reference of a group. Active regions have k = 0 and their weights as selections, others k = -1 and
/// selection 0. All active ones but the reference are sliding surfaces (g_r = g_i); of the reference itself there is
/// nothing to watch.
/// @return the reference of a group in a mode; -1 if the mode is not decided yet
[[nodiscard]] int reference_of(const ModeState& state, const evaluation::RegionRange& group);

/// Measures the regions of all groups against their references in this mode.
void set_references(evaluation::ModelKernel& kernel, const ModeState& state);

/// Holds a region and its weight theta.
struct ActiveRegion {
  int region = 0;
  double weight = 0.0;
};
/// Makes these regions of a group the active ones, the first of them its reference.
void set_active(ModeState& state, const evaluation::RegionRange& group, const std::vector<ActiveRegion>& active);

/// Makes a region that a decision has put above 0 the reference of its group. It is the smallest one behind it.
void rebase(const evaluation::ModelKernel& kernel, ModeState& state, std::vector<int>& zero_order);

/// Gives every reference the weight that the others leave, in the selections of the mode and of its two corners.
void complete_weights(const evaluation::ModelKernel& kernel, ModeState& state);

/// Returns whether both are regions of the same group.
[[nodiscard]] bool same_group(const evaluation::ModelKernel& kernel, int i, int j);

/// Measures against the references of a mode, and again against those from before at its end.
class ReferenceScope {
 public:
  ReferenceScope(evaluation::ModelKernel& kernel, const ModeState& state);
  ~ReferenceScope();
  ReferenceScope(const ReferenceScope&) = delete;
  ReferenceScope& operator=(const ReferenceScope&) = delete;

 private:
  evaluation::ModelKernel& kernel_;
  std::vector<int> before_;
};

}  // namespace saltus::event_integrator
