#include "saltus/frontend/check_text.hpp"

#include <fmt/format.h>

#include "saltus/frontend/optimize_text.hpp"
#include "saltus/frontend/overview_text.hpp"
#include "saltus/frontend/reformulation_text.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/model/summary.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "saltus/smoothed/regularise.hpp"

namespace saltus::frontend {
namespace {

bool is_large(const model::System& system) { return system.switching.size() > most_reformulated; }

/// Which methods can run the model.
std::string methods_text(const model::System& system) {
  if (is_large(system)) {
    return fmt::format("\nmethods: event\n  others: not tried, more than {} switching functions\n", most_reformulated);
  }
  const auto regularisation = smoothed::regularise(system, pipeline::SmoothedOptions{}.epsilon);
  if (system.frozen) {
    const auto& frozen = system.frozen->system();
    const auto dcs = frozen.and_then([](const auto& made) { return reformulation::reformulate(made); });
    std::string text =
        fmt::format("\nmethods: event{}\n", dcs ? ", fesd (time stands still at contacts and in hysteresis)" : "");
    if (!dcs) text += fmt::format("  fesd: {}\n", dcs.error().message);
    return text;
  }
  const auto dcs = reformulation::reformulate(system);
  std::string text =
      fmt::format("\nmethods: event{}{}\n", regularisation ? ", smoothed" : "", dcs ? ", fesd, timestepping" : "");
  if (!regularisation) text += fmt::format("  smoothed: {}\n", regularisation.error().message);
  if (!dcs) text += fmt::format("  fesd, timestepping: {}\n", dcs.error().message);
  return text;
}

}  // namespace

std::string check_text(const ModelInput& input, const model::System& system, const io::ModelOverview& overview,
                       const std::optional<pipeline::OcpOverview>& optimization) {
  return overview_text(overview, input.path) + methods_text(system) + warnings_text(overview) +
         (optimization ? optimize_text(*optimization) : "");
}

Expected<std::string> check_text(const ModelInput& input) {
  const auto system = model::build(input.file.description, input.overrides);
  if (!system) return tl::unexpected(system.error());
  const auto optimization = optimize_overview(input);
  if (!optimization) return tl::unexpected(optimization.error());
  const auto overview = io::overview_of(input.file.description, model::summary_of(*system), input.file.captions);
  return check_text(input, *system, overview, *optimization);
}

}  // namespace saltus::frontend
