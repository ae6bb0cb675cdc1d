// Runs of models with groups of modes by indicator.
#pragma once

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator::testing {

/// With DOP853 and tight tolerances; `initial_mode` by numbers of switching functions.
inline Integration run_regions(model::Builder& builder, double until,
                               std::vector<std::pair<int, int>> initial_mode = {}) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
  auto kernel = evaluation::ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = {1e-11, 1e-13};
  options.until = until;
  options.initial_mode = std::move(initial_mode);
  return integrate(*kernel, *system, options);
}

}  // namespace saltus::event_integrator::testing
