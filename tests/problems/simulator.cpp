#include "problems/simulator.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "saltus/expression/parser.hpp"
#include "saltus/io/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::problems {
namespace {

template <class T>
T value_or_throw(Expected<T> expected) {
  if (!expected) throw std::runtime_error(to_text(expected.error()));
  return *std::move(expected);
}

expression::NodePtr scaled(double factor, const expression::NodePtr& node) {
  const SourceLocation here{.file = "psi_scale"};
  const expression::Binary product{expression::BinaryOperator::multiply, expression::number(factor, here), node};
  return std::make_shared<const expression::Node>(expression::Node{.value = product, .location = here});
}

bool is_declared(const model::Description& description, const std::string& name) {
  return std::any_of(description.switching.begin(), description.switching.end(),
                     [&](const model::NamedExpression& psi) { return psi.name == name; });
}

/// Named switching functions and indicators get the factor; every unnamed one gets an equal named one, found by parsing
/// its name.
void scale_switching_functions(model::Description& description, const std::vector<model::Override>& overrides,
                               double factor) {
  const model::System unscaled = value_or_throw(model::build(description, overrides));
  std::vector<model::NamedExpression> added;
  for (const model::SwitchingColumn& column : unscaled.columns) {
    if (is_declared(description, column.name)) continue;
    const SourceLocation here{.file = "psi_scale"};
    const expression::NodePtr psi = value_or_throw(expression::parse(column.name, here));
    added.push_back({"scaled" + std::to_string(added.size() + 1), scaled(factor, psi), here});
  }
  for (model::NamedExpression& psi : description.switching) psi.expression = scaled(factor, psi.expression);
  for (model::ModeDescription& mode : description.modes) {
    if (mode.indicator) mode.indicator = scaled(factor, mode.indicator);
  }
  description.switching.insert(description.switching.end(), added.begin(), added.end());
}

io::ModelFile read_from_catalogue(const std::string& name) {
  return value_or_throw(io::read_model(std::filesystem::path(SALTUS_SOURCE_DIR "/models") / (name + ".toml")));
}

}  // namespace

struct Simulator::Parts {
  model::System system;
  pipeline::SimulateOptions options;
};

Simulator::Simulator(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

Simulator Simulator::from_reference(const ReferenceProblem& problem, double psi_scale) {
  io::ModelFile file = read_from_catalogue(problem.model);
  std::vector<model::Override> overrides;
  for (const auto& [name, value] : problem.overrides) {
    overrides.push_back({name, expression::number(value, SourceLocation{.file = "override"})});
  }
  if (psi_scale != 1.0) scale_switching_functions(file.description, overrides, psi_scale);
  auto parts = std::make_unique<Parts>();
  parts->system = value_or_throw(model::build(file.description, overrides));
  parts->options = file.simulate;
  parts->options.until = problem.until;
  parts->options.native = pipeline::Native::off;
  parts->options.initial_mode = problem.initial_mode;
  if (psi_scale != 1.0 && !problem.initial_mode.empty()) {
    // a scaled unnamed switching function has a new name; columns keep their order
    for (auto& [name, mode] : parts->options.initial_mode) name = parts->system.columns.front().name;
  }
  return Simulator(std::move(parts));
}

Simulator Simulator::from_file(const io::ModelFile& file) {
  auto parts = std::make_unique<Parts>();
  parts->system = value_or_throw(model::build(file.description));
  parts->options = file.simulate;
  parts->options.native = pipeline::Native::off;
  return Simulator(std::move(parts));
}

Simulator Simulator::from_catalogue(const std::string& name) { return from_file(read_from_catalogue(name)); }

Simulator Simulator::from_text(std::string_view toml) {
  return from_file(value_or_throw(io::parse_model(toml, "test.toml")));
}

const pipeline::SimulateOptions& Simulator::options() const { return parts_->options; }

void Simulator::set_initial_state(const std::vector<double>& x) { parts_->system.initial_state = x; }

void Simulator::set_until(double t) { parts_->options.until = t; }

result::Result Simulator::run(const pipeline::SimulateOptions& options) const {
  return value_or_throw(pipeline::simulate(parts_->system, options));
}

pipeline::SimulateOptions with(pipeline::SimulateOptions options, const Accuracy& accuracy) {
  options.rtol = accuracy.rtol;
  options.atol = accuracy.atol;
  options.event.integrator = accuracy.integrator;
  return options;
}

std::vector<result::Event> switches_of(const result::Result& result) {
  std::vector<result::Event> events = result.events;
  std::erase_if(events, [](const result::Event& event) { return event.kind == result::EventKind::start; });
  return events;
}

}  // namespace saltus::problems
