// What a run says where it cannot go on, or where its numbers mean less than they seem to.
#pragma once

#include <optional>
#include <string>

#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/run/context_internal.hpp"
#include "saltus/fesd_integrator/run/position_internal.hpp"
#include "saltus/fesd_integrator/watch/coarseness.hpp"

namespace saltus::fesd_integrator {

/// Names a derivative of the field or of a switching function that is not finite at the position (a root of zero), and
/// what that means for elements; nullopt: all are. `nominal`: length of a simulation step.
[[nodiscard]] std::optional<std::string> steep_derivative(RunContext& context, const Position& position,
                                                          double nominal);
/// Names a value that is not finite a little further along the right-hand side; nullopt if all are.
[[nodiscard]] std::optional<std::string> undefined_beyond(RunContext& context, const Position& position,
                                                          double nominal);
[[nodiscard]] std::string coarse_message(const Facts& facts, const Coarseness::Worst& worst);
/// Names the surfaces that slide at the position where nothing determines all selections.
[[nodiscard]] std::string undetermined_message(const RunContext& context, const Position& position,
                                               const Recorder& recorder);

}  // namespace saltus::fesd_integrator
