// One run of a sweep as it is stated.
#pragma once

#include "saltus/model/system.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"

namespace saltus::pipeline {

/// Holds one run: a system with its values, and the options.
struct StatedRun {
  model::System system{};
  SimulateOptions options{};
};

}  // namespace saltus::pipeline
