// One model by every engine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Returns the most accurate setting of the event engine: dop853 with rtol 1e-13, atol 1e-15; for a model whose options
/// name radau5 (a stiff one: the explicit methods would need its shortest time as step) radau5 with rtol 1e-12, atol
/// 1e-14. Everything else as in `options`.
[[nodiscard]] SimulateOptions reference_options(SimulateOptions options);

/// Returns "dop853, rtol 1e-13, atol 1e-15"
[[nodiscard]] std::string reference_name(const SimulateOptions& reference);

/// Holds what `found` and `reference` have in common, as far as both got to their ends.
struct Agreement {
  std::optional<double> state_difference;        ///< max_i |x_i - x_i of the reference| at the end
  std::optional<double> switch_time_difference;  ///< max_k |t_k - t_k of the reference|, if there are as many
};
[[nodiscard]] Agreement agreement(const result::Result& found, const result::Result& reference);

/// Simulates the system with every method, first with the most accurate one.
/// @param options  those of the model; method, integrator and branches are replaced
/// @return the result of the reference run, with a `comparison` of all runs: one that cannot be made is a row with its
///         reason. An Error only if the reference cannot be started.
/// `observers` see every run as a trajectory of so many.
[[nodiscard]] Expected<result::Result> compare(const model::System& system, const SimulateOptions& options,
                                               const Observers& observers = {});

}  // namespace saltus::pipeline
