// Runs of models made by a Builder.
#pragma once

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator::testing {

inline constexpr ode::Method every_method[] = {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5,
                                               ode::Method::taylor};

/// Builds, compiles and runs; any failure before the run is one of the test.
inline Integration run_model(model::Builder& builder, const IntegrationOptions& options) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
  auto kernel = evaluation::ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  return integrate(*kernel, options);
}

/// With DOP853; `initial_mode` by numbers of switching functions.
inline Integration run_model(model::Builder& builder, double until, ode::Tolerances tolerances,
                             std::vector<std::pair<int, int>> initial_mode = {}) {
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = tolerances;
  options.until = until;
  options.initial_mode = std::move(initial_mode);
  return run_model(builder, options);
}

/// The same with tolerances far below those of the expectations.
inline Integration run_tightly(model::Builder& builder, double until,
                               std::vector<std::pair<int, int>> initial_mode = {}) {
  return run_model(builder, until, {1e-11, 1e-13}, std::move(initial_mode));
}

}  // namespace saltus::event_integrator::testing
