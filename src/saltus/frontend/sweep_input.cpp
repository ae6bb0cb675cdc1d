#include "saltus/frontend/sweep_input.hpp"

#include <algorithm>
#include <utility>

#include "saltus/model/build.hpp"
#include "saltus/pipeline/options/stated_run.hpp"

namespace saltus::frontend {
namespace {

/// An error of a value that the sweep has set, with the flag that the user wrote.
Error told_as_swept(Error error, const SweepPlan& plan) {
  const std::string set = "--set";
  for (std::size_t k = 0; k < plan.names().size(); ++k) {
    const std::string setting = set + " " + plan.names()[k];
    auto& place = error.location.file;
    if (place == setting || place.starts_with(setting + "=")) place.replace(0, set.size(), plan.flag(k));
    for (auto& frame : error.context) {
      if (frame == "in " + setting) frame = "in " + plan.flag(k) + " " + plan.names()[k];
    }
  }
  return error;
}

}  // namespace

Expected<ModelInput> input_of_run(const ModelInput& model, const SweepPlan& plan, std::size_t run) {
  auto input = model;
  const auto values = plan.values(run);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (auto done = apply_setting(input, plan.names()[k] + "=" + values[k]); !done) {
      auto error = told_as_swept(done.error(), plan);
      if (is_list_of_others(values[k])) {
        error.message = "expected values with commas between, or FROM:TO:NUMBER";
        error.remedy = over_remedy;
        error.location.line = error.location.column = 0;
      }
      return tl::unexpected(std::move(error));
    }
  }
  if (auto fits = io::check_options(input.file); !fits) return tl::unexpected(fits.error());
  return input;
}

Expected<void> check_branches(const ModelInput& run, const SweepPlan& plan) {
  const auto swept = std::find(plan.names().begin(), plan.names().end(), "simulate.event.branches");
  if (run.file.simulate.event.trajectories == 1 && swept == plan.names().end()) return {};
  return tl::unexpected(Error{
      ErrorCode::invalid_option,
      "a sweep takes no --branch: it follows one motion of every run, and its column 'unique' says where others are "
      "admissible",
      "leave it out (--branch report where the model has simulate.event.branches); saltus simulate --branch all "
      "follows "
      "the others of one run",
      {},
      {}});
}

Expected<pipeline::StatedRun> state_run(const ModelInput& model, const SweepPlan& plan, std::size_t run) {
  auto input = input_of_run(model, plan, run);
  if (!input) return tl::unexpected(input.error());
  auto system = model::build(input->file.description, input->overrides);
  if (!system) return tl::unexpected(told_as_swept(io::located(system.error(), input->file), plan));
  return pipeline::StatedRun{std::move(*system), std::move(input->file.simulate)};
}

}  // namespace saltus::frontend
