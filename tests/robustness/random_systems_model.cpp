#include "random_systems_model.hpp"

#include <set>
#include <stdexcept>
#include <utility>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/fesd_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "states.hpp"

namespace saltus::robustness {
namespace {

using casadi::SX;

class BuilderSwitches {
 public:
  explicit BuilderSwitches(model::Builder& builder) : builder_(builder) {}

  SX step(std::size_t surface, const SX& psi) {
    // A name is declared once; its later uses are recognised as equal.
    if (!declared_.insert(surface).second) return builder_.step(psi);
    return builder_.step(builder_.switching("s" + std::to_string(surface), psi));
  }
  SX max(const SX& a, const SX& b) { return builder_.max(a, b); }
  SX abs(const SX& a) { return builder_.abs(a); }

 private:
  model::Builder& builder_;
  std::set<std::size_t> declared_;
};

model::System to_model(const RandomSystem& random) {
  model::Builder builder("random " + name(random.family) + " " + std::to_string(random.seed));
  std::vector<SX> x;
  for (std::size_t i = 0; i < random.states; ++i) {
    model::Values values;
    values.initial = random.start[i];
    x.push_back(builder.state("x" + std::to_string(i), values));
  }
  BuilderSwitches switches(builder);
  const auto xdot = rates(random, builder.time(), x, switches);
  for (std::size_t i = 0; i < random.states; ++i) builder.dynamics("x" + std::to_string(i), xdot[i]);
  auto system = builder.build();
  if (!system) throw std::runtime_error(to_text(system.error()));
  return std::move(*system);
}

}  // namespace

struct Model::Parts {
  model::System system;
  evaluation::ModelKernel kernel;
  std::vector<bool> listed;
};

Model::Model(const RandomSystem& random) {
  auto system = to_model(random);
  auto kernel = evaluation::ModelKernel::compile(system);
  if (!kernel) throw std::runtime_error(to_text(kernel.error()));
  std::vector<bool> listed;
  for (const auto& column : system.columns) {
    const auto& function = system.switching[static_cast<std::size_t>(column.function)];
    listed.push_back(function.role == model::SwitchingRole::listed);
  }
  if (system.columns.size() != random.surfaces) throw std::runtime_error("not one column per surface");
  parts_ = std::make_unique<Parts>(Parts{std::move(system), std::move(*kernel), std::move(listed)});
}

Model::~Model() = default;

ode::Method method_of(Integrator integrator) {
  switch (integrator) {
    case Integrator::dopri5:
      return ode::Method::dopri5;
    case Integrator::dop853:
      return ode::Method::dop853;
    case Integrator::taylor:
      return ode::Method::taylor;
  }
  __builtin_unreachable();
}

result::Result Model::run(const Accuracy& accuracy, const std::vector<double>& start) const {
  event_integrator::IntegrationOptions options;
  options.method = method_of(accuracy.integrator);
  options.tolerances = {accuracy.rtol, accuracy.rtol / 100.0};
  options.until = end_time;
  // Contracting fields need a few hundred steps, and a few thousand events at most: more is a run that got stuck.
  options.max_steps = 200000;
  parts_->kernel.set_initial_state(start);
  auto run = event_integrator::integrate(parts_->kernel, options);
  result::Result result;
  for (const auto& column : parts_->system.columns) result.switching_functions.push_back(column.name);
  result.status = std::move(run.status);
  result.final = std::move(run.final);
  result.events = std::move(run.events);
  result.trajectory = std::move(run.trajectory);
  result.statistics = run.statistics;
  return result;
}

result::Result Model::run(const Elements& elements) const {
  fesd_integrator::IntegrationOptions options;
  auto tableau = discretization::butcher_tableau(discretization::TableauFamily::radau_iia, elements.stages);
  const auto form = elements.form == Reformulation::step ? reformulation::Form::step : reformulation::Form::stewart;
  const auto dcs = reformulation::reformulate(parts_->system, {.reformulation = form, .lifting = std::nullopt});
  if (!tableau || !dcs) throw std::runtime_error("not reformulated");
  options.tableau = std::move(*tableau);
  options.until = end_time;
  options.steps = elements.steps;
  auto run = fesd_integrator::integrate(parts_->system, *dcs, options);
  if (!run) throw std::runtime_error(to_text(run.error()));
  result::Result result;
  result.status = std::move(run->status);
  result.final = std::move(run->final);
  result.events = std::move(run->events);
  return result;
}

const std::vector<bool>& Model::listed() const { return parts_->listed; }

bool Model::has_equal_surfaces() const {
  std::set<int> functions;
  for (const auto& column : parts_->system.columns) functions.insert(column.function);
  return functions.size() < parts_->system.columns.size();
}

}  // namespace saltus::robustness
