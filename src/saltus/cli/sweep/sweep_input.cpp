#include "saltus/cli/sweep/sweep_input.hpp"

#include <utility>

#include "saltus/model/build.hpp"

namespace saltus::cli {

Expected<ModelInput> input_of_run(const ModelInput& model, const SweepPlan& plan, std::size_t run) {
  auto input = model;
  const auto values = plan.values(run);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (auto done = apply_setting(input, plan.names()[k] + "=" + values[k]); !done) return tl::unexpected(done.error());
  }
  if (auto fits = io::check_options(input.file); !fits) return tl::unexpected(fits.error());
  return input;
}

Expected<pipeline::StatedRun> state_run(const ModelInput& model, const SweepPlan& plan, std::size_t run) {
  auto input = input_of_run(model, plan, run);
  if (!input) return tl::unexpected(input.error());
  auto system = model::build(input->file.description, input->overrides);
  if (!system) return tl::unexpected(io::located(system.error(), input->file));
  return pipeline::StatedRun{std::move(*system), std::move(input->file.simulate)};
}

}  // namespace saltus::cli
