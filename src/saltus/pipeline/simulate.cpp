#include "saltus/pipeline/simulate.hpp"

#include <memory>
#include <optional>
#include <variant>

#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/model/mechanics/contacts_at_start.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/simulate/dropped_under_lock_internal.hpp"
#include "saltus/pipeline/simulate/error_estimate_internal.hpp"
#include "saltus/pipeline/simulate/methods_internal.hpp"
#include "saltus/pipeline/simulate/simulation_internal.hpp"

namespace saltus::pipeline {
namespace {

std::optional<Error> find_mistake_at_start(const model::System& system, const SimulateOptions& options) {
  if (auto error = model::find_stale(system)) return error;
  const SymbolicLock lock;
  return model::check_contacts_at_start(system, options.from);
}

/// The system with its forces as written, for methods that are none of events; null: it is that already.
std::shared_ptr<const model::System> as_written(const model::System& system, Method method) {
  const auto& other = system.frozen;
  if (method == Method::event || !other || !other->system() || other->system()->freezing) return nullptr;
  const SymbolicLock lock;
  return dropped_under_lock(model::with_values_of(*other->system(), system));
}

Expected<result::Result> by_its_method(const Simulation& asked, KernelStore& kernels) {
  switch (asked.options.method) {
    case Method::event:
      return simulate_event(asked, kernels);
    case Method::smoothed:
      return simulate_smoothed(asked, kernels);
    case Method::fesd:
    case Method::timestepping:
      return asked.system.frozen ? simulate_frozen(asked) : simulate_elements(asked);
  }
  __builtin_unreachable();
}

}  // namespace

Expected<result::Result> simulate(const model::System& system, const SimulateOptions& options,
                                  const Observers& observers, KernelStore* kernels) {
  if (auto error = find_mistake_at_start(system, options)) return tl::unexpected(*error);
  const auto written = as_written(system, options.method);
  if (written) {
    if (auto error = find_mistake_at_start(*written, options)) return tl::unexpected(*error);
  }
  const auto asked = checked_simulation(written ? *written : system, options, observers);
  if (!asked) return tl::unexpected(asked.error());
  KernelStore of_this_run;
  KernelStore& store = kernels != nullptr ? *kernels : of_this_run;
  auto result = by_its_method(*asked, store);
  if (!result) return result;
  finish_result(asked->system, *result);
  if (!options.error_estimate) return result;
  // Its rows are those of the run that was asked for, and of nobody else.
  const Observers without_parts{observers.on_step, {}};
  auto errors = estimate_errors(*result, asked->options, [&](const SimulateOptions& other) {
    return simulate(system, other, without_parts, &store);
  });
  if (!errors) return tl::unexpected(errors.error());
  result->error_estimate = std::move(*errors);
  return result;
}

void leave_out_rows(const model::System& system, SimulateOptions& options) {
  const bool times_are_checked = std::holds_alternative<AtTimes>(options.output);
  if (options.method != Method::event || times_are_checked || !system.contacts.empty()) return;
  options.output = NumberOfPoints{2};
}

}  // namespace saltus::pipeline
