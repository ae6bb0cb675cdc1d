// From an optimal control problem to certified controls.
#pragma once

#include <functional>
#include <string>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

struct OptimizeObservers {
  std::function<bool()> is_interrupted = [] { return false; };
  std::function<void(const std::string&)> on_warning = [](const std::string&) {};
  std::function<void(const result::HomotopyStep&)> on_step = [](const result::HomotopyStep&) {};
};

/// Solves the problem by finite elements with switch detection as an MPCC, certifies the point, and simulates it again
/// with the event engine. The result has command "optimize", method "fesd" and Result::optimization. Numerical outcomes
/// are the result's status. Fails for bad input:
/// - options outside their ranges;
/// - models that the method does not cover;
/// - a cost or constraint that is not finite at the guess;
/// - more equality constraints than freedom.
[[nodiscard]] Expected<result::Result> optimize(const model::Ocp& ocp, const OptimizeOptions& options,
                                                const OptimizeObservers& observers = {});

}  // namespace saltus::pipeline
