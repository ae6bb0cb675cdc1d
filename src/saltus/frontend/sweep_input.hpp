// The runs of a sweep, stated from the model file.
#pragma once

#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/frontend/sweep_plan.hpp"
#include "saltus/pipeline/sweep.hpp"

namespace saltus::frontend {

/// Returns the model with the values of one run; fails as `saltus simulate` does with the same settings.
[[nodiscard]] Expected<ModelInput> input_of_run(const ModelInput& model, const SweepPlan& plan, std::size_t run);

/// Fails where the model, as one of its runs states it, or the plan asks to follow other motions: a table has no place
/// for them.
[[nodiscard]] Expected<void> check_branches(const ModelInput& run, const SweepPlan& plan);

/// Returns the same as a system. To be called under the symbolic lock.
[[nodiscard]] Expected<pipeline::StatedRun> state_run(const ModelInput& model, const SweepPlan& plan, std::size_t run);

}  // namespace saltus::frontend
