#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/stop.hpp"
#include "saltus/fesd_integrator/run/diagnosis_internal.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Estimates are those inside elements, which are larger than those at their ends, and errors grow or decay behind
/// them: of the models of the catalogue with 100 steps all with errors above 1 % at the end are above this.
constexpr double coarse = 0.03;

PartLength::Shape shape_of(const IntegrationOptions& options) {
  using Errors = PartLength::Shape::Errors;
  return {(options.until - options.from) / static_cast<double>(options.steps), options.elements,
          options.tableau.stages(), options.error_limit ? Errors::limited : Errors::ignored};
}

}  // namespace

Run::Run(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions, const Facts& facts,
         const IntegrationOptions& options, const StepObserver& observer, SensitivityPropagation* propagation)
    : context_(kernel, functions, facts, options),
      position_(options.from, facts.initial_state, kernel.selections()),
      status_(options, observer),
      length_(shape_of(options)),
      coarseness_(options.error_limit, options.until - options.from),
      chain_(context_, position_, length_, coarseness_),
      locator_(context_, position_, length_, chain_),
      transition_(kernel, facts.parts, context_.solver),
      rest_(kernel),
      fixed_(kernel, facts.parts, context_.solver),
      recorder_(functions, facts),
      element_recorder_(options.record_elements ? std::optional<ElementRecorder>({kernel, facts, options.tableau})
                                                : std::nullopt),
      interior_(context_, position_),
      rows_(context_, position_, interior_, recorder_),
      events_(context_, position_, interior_, rows_, recorder_, status_),
      tangents_(context_, position_, propagation) {}

void Run::stop(result::Termination termination, std::string message) {
  status_.stop(position_.t(), termination, std::move(message));
}

Integration Run::run() {
  // Inside of an element that takes long, too.
  const StopScope scope([&] {
    status_.show_progress(position_.t(), recorder_.events(), position_.x());
    return stopped();
  });
  try {
    start();
    take_elements();
  } catch (const Stopped&) {
    stop(result::Termination::stopped_by_user, fmt::format("stopped at t = {:.10g}", position_.t()));
  }
  return take_integration();
}

void Run::take_elements() {
  const IntegrationOptions& options = context_.options;
  const auto steps = static_cast<double>(options.steps);
  for (long k = 0; k < options.steps && !stopped(); ++k) {
    // From the ends, not by adding up: no drift in time.
    const double end = k + 1 == options.steps
                           ? options.until
                           : options.from + (options.until - options.from) * (static_cast<double>(k + 1) / steps);
    while (!stopped() && position_.t() < end) {
      const double change = context_.held.next_change(position_.t(), end, position_.x().data());
      tangents_.set_time_event(change, context_.held.next_changing());
      if (options.step_problem != nullptr) {
        advance_by_problem(*options.step_problem, change);
      } else if (options.switches == IntegrationOptions::Switches::detected) {
        advance(change);
      } else {
        advance_fixed(change);
      }
      if (!stopped() && !context_.facts.held.empty()) hold_behind();
    }
    status_.show_progress(position_.t(), recorder_.events(), position_.x());
  }
}

Integration Run::take_integration() {
  Integration integration;
  if (recorder_.trajectory().t.empty() || !recorder_.ends_at(position_.t())) {
    recorder_.row(position_.t(), position_.x(), position_.set(), position_.selections(), context_.held.data());
  }
  if (const auto worst = coarseness_.worst()) {
    status_.statistics().error_estimate = worst->sum;
    if (worst->sum > context_.options.error_limit.value_or(coarse)) {
      status_.remark(coarse_message(context_.facts, *worst));
    }
  }
  integration.status = status_.at_end(position_.t());
  integration.final = recorder_.last();
  integration.events = std::move(recorder_.event_list());
  integration.trajectory = std::move(recorder_.trajectory());
  if (element_recorder_) integration.elements = element_recorder_->take();
  integration.statistics = status_.statistics();
  integration.statistics.rhs_evaluations = context_.kernel.evaluations();
  return integration;
}

bool Run::put_forced_first(std::vector<Continuation>& found) const {
  const auto& forced = context_.options.initial_mode;
  const auto chosen = std::find_if(found.begin(), found.end(), [&](const Continuation& candidate) {
    const auto view = recorder_.view(candidate.set, candidate.selections, context_.held.data());
    return std::all_of(forced.begin(), forced.end(),
                       [&](const auto& entry) { return view.mode[at(entry.first)] == entry.second; });
  });
  if (chosen == found.end()) return false;
  std::rotate(found.begin(), chosen, chosen + 1);
  return true;
}

std::vector<int> Run::functions_at_zero() const {
  const ActiveSet at_zero(context_.facts.parts, transition_.modes_at_zero());
  const auto zero = recorder_.view(at_zero, position_.selections(), context_.held.data());
  std::vector<int> functions;
  for (std::size_t j = 0; j < zero.mode.size(); ++j) {
    if (zero.mode[j] == 0) functions.push_back(static_cast<int>(j));
  }
  for (const auto& group : context_.facts.regions) {
    // A region that is active alone is not on a surface.
    const auto in_group = [&](int j) {
      return j >= group.first && j < group.first + static_cast<int>(group.names.size());
    };
    if (std::count_if(functions.begin(), functions.end(), in_group) == 1) std::erase_if(functions, in_group);
  }
  return functions;
}

void Run::start() {
  const auto& parts = context_.facts.parts;
  context_.held.set_behind(position_.t(), length_.nominal(), position_.x().data());
  std::vector<int> below(context_.kernel.selections(), -1);
  for (const Part& part : parts) {
    if (part.simplex) below[at(part.first)] = 0;
  }
  const ActiveSet set(parts, below);
  auto selections = position_.selections();
  set.selections(selections.data(), selections.data());
  position_.continue_with(set, selections);
  auto found = continuations(nullptr, {});
  if (!put_forced_first(found)) {
    if (stopped_where_not_finite()) return;
    stop(result::Termination::no_admissible_mode,
         context_.options.initial_mode.empty()
             ? fmt::format("no mode continues the solution from the start at t = {:.10g}", position_.t())
             : fmt::format("no mode with the forced initial_mode continues the solution from t = {:.10g}",
                           position_.t()));
    return;
  }
  const auto functions = functions_at_zero();
  continue_with(found);
  events_.start();
  recorder_.started(position_.t(), position_.x(), found, context_.held.data(), functions);
  if (chain_.warps().behind(length_.nominal()) > 1)
    cycles_.add({position_.t(), position_.set().modes(), position_.x(), 0.0});
  rows_.emit_here();
}

}  // namespace saltus::fesd_integrator
