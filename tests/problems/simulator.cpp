#include "problems/simulator.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "problems/value_or_throw.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "source_folder.hpp"

namespace saltus::problems {
namespace {

io::ModelFile read_from_catalogue(const std::string& name) {
  return value_or_throw(io::read_model(tests::source_folder("models") / (name + ".toml")));
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

Simulator Simulator::from_reference(const ReferenceProblem& problem, const Relabelling& relabelling) {
  io::ModelFile file = read_from_catalogue(problem.model);
  std::vector<model::Override> overrides;
  for (const auto& [name, value] : problem.overrides) {
    overrides.push_back({name, expression::number(value, SourceLocation{.file = "override"})});
  }
  file.simulate.until = problem.until;
  file.simulate.initial_mode = problem.initial_mode;
  return from_file(std::move(file), overrides, relabelling);
}

Simulator Simulator::from_file(io::ModelFile file, const std::vector<model::Override>& overrides,
                               const Relabelling& relabelling) {
  if (!relabelling.name.empty()) relabel(file, overrides, relabelling);
  auto parts = std::make_unique<Parts>();
  parts->system = value_or_throw(model::build(file.description, overrides));
  parts->options = file.simulate;
  parts->options.native = pipeline::Native::off;
  return Simulator(std::move(parts));
}

Simulator Simulator::from_catalogue(const std::string& name) { return from_file(read_from_catalogue(name), {}, {}); }

Simulator Simulator::from_text(std::string_view toml, const Relabelling& relabelling) {
  return from_file(value_or_throw(io::parse_model(toml, "test.toml")), {}, relabelling);
}

const pipeline::SimulateOptions& Simulator::options() const { return parts_->options; }

void Simulator::set_initial_state(const std::vector<double>& x) { parts_->system.initial_state = x; }

void Simulator::set_until(double t) { parts_->options.until = t; }

result::Result Simulator::run(const pipeline::SimulateOptions& options, pipeline::KernelStore* kernels) const {
  return value_or_throw(pipeline::simulate(parts_->system, options, {}, kernels));
}

pipeline::SimulateOptions with(pipeline::SimulateOptions options, const Accuracy& accuracy) {
  options.rtol = accuracy.rtol;
  options.atol = accuracy.atol;
  options.event.integrator = accuracy.integrator;
  return options;
}

result::Result simulate_text(const std::string& toml, const Accuracy& accuracy) {
  const Simulator simulator = Simulator::from_text(toml);
  return simulator.run(with(simulator.options(), accuracy));
}

std::vector<result::Event> switches_of(const result::Result& result) {
  std::vector<result::Event> events = result.events;
  std::erase_if(events, [](const result::Event& event) { return event.kind == result::EventKind::start; });
  return events;
}

}  // namespace saltus::problems
