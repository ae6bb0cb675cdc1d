// Optimal control problems of a system stated in C++, for tests of what is done with them.
#pragma once

#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::pipeline {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Nothing free, no costs, no constraints: tests add theirs over the outputs of the builder.
inline model::Ocp problem_of(model::Builder& builder, double horizon) {
  auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  model::Ocp ocp;
  if (!system) return ocp;
  ocp.system = std::move(*system);
  ocp.user_controls = static_cast<int>(ocp.system.control_names.size());
  ocp.user_outputs = static_cast<int>(ocp.system.output_names.size());
  ocp.horizon = {false, horizon, horizon, horizon};
  ocp.free_states.assign(ocp.system.state_names.size(), false);
  ocp.free_parameters.assign(ocp.system.parameter_names.size(), false);
  ocp.parameter_lower = ocp.parameter_upper = ocp.system.parameter_values;
  return ocp;
}

inline model::OcpConstraint constraint(int output, double lower, double upper) {
  model::OcpConstraint made;
  made.name = "constraint";
  made.output = output;
  made.lower = lower;
  made.upper = upper;
  return made;
}

}  // namespace saltus::pipeline
