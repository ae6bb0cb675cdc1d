#include "saltus/model/builder.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/builder_parts_internal.hpp"
#include "saltus/model/frozen_system.hpp"

namespace saltus::model {

using casadi::SX;

Builder::Builder(std::string name) : parts_(std::make_unique<Parts>()) {
  parts_->statement.name = std::move(name);
  parts_->statement.time = parts_->recognition.graph.symbol("t", {.kind = VariableKind::time});
}

Builder::~Builder() = default;
Builder::Builder(Builder&&) noexcept = default;
Builder& Builder::operator=(Builder&&) noexcept = default;

void Builder::set_description(std::string text) { parts_->statement.description = std::move(text); }
void Builder::set_inclusion(Inclusion inclusion) { parts_->statement.inclusion = inclusion; }

SX Builder::time() const { return SX(parts_->statement.time); }

SX Builder::parameter(const std::string& name, double value) {
  auto& parameters = parts_->statement.parameters;
  if (!parts_->declare(name, NameKind::parameter, parameters.size())) return SX(0.0);
  if (!std::isfinite(value)) {
    parts_->refuse(fmt::format("the parameter '{}' is {}, not a finite number", name, value),
                   "check where its value comes from");
  }
  const SX symbol = parts_->symbol(
      name, {.kind = VariableKind::parameter, .index = static_cast<int>(parameters.size()), .value = value});
  parameters.push_back({name, symbol.scalar(), value});
  return symbol;
}

SX Builder::state(const std::string& name, const Values& values) {
  auto& states = parts_->statement.states;
  if (!parts_->declare(name, NameKind::state, states.size())) return SX(0.0);
  parts_->add_state(name, values, VariableKind::state);
  return SX(states.back().symbol);
}

SX Builder::discrete_state(const std::string& name, double initial) {
  auto& states = parts_->statement.states;
  if (!parts_->declare(name, NameKind::state, states.size())) return SX(0.0);
  parts_->add_state(name, {.initial = initial}, VariableKind::discrete);
  return SX(states.back().symbol);
}

SX Builder::hysteresis(const std::string& name, const SX& input, const HysteresisValues& values) {
  auto& states = parts_->statement.states;
  if (!parts_->declare(name, NameKind::hysteresis, states.size())) return SX(0.0);
  const SXElem e = parts_->entry(input, "input of " + name);
  parts_->add_state(name, {.initial = values.initial}, VariableKind::discrete);
  const auto state = static_cast<int>(states.size()) - 1;
  const HysteresisThresholds thresholds{name, values.on, values.off, values.initial, {}};
  if (auto error = state_hysteresis(parts_->recognition, parts_->statement, state, e, thresholds)) parts_->fail(*error);
  parts_->hysteresis.push_back({state, e, thresholds});
  return SX(states.back().symbol);
}

SX Builder::control(const std::string& name, const Values& values) {
  auto& controls = parts_->statement.controls;
  if (!parts_->declare(name, NameKind::control, controls.size())) return SX(0.0);
  const Bounds bounds{values.lower, values.upper};
  if (auto error =
          check_values(fmt::format("control '{}'", name), values.initial, bounds, {}, parts_->statement.warnings)) {
    parts_->fail(*error);
  }
  const SX symbol = parts_->symbol(
      name, {.kind = VariableKind::control, .index = static_cast<int>(controls.size()), .value = values.initial});
  controls.push_back({.name = name, .symbol = symbol.scalar(), .initial = values.initial, .bounds = bounds});
  return symbol;
}

SX Builder::switching(const std::string& name, const SX& psi) {
  auto& switching = parts_->statement.switching;
  const SXElem e = parts_->entry(psi, "switching function " + name);
  if (!parts_->declare(name, NameKind::switching, switching.size())) return psi;
  return parts_->kept([&]() -> Expected<SXElem> {
    const auto declared = parts_->recognition.declare(name, e);
    if (!declared) return tl::unexpected(declared.error());
    switching.push_back({.declared = *declared});
    return e;
  });
}

SX Builder::step(const SX& e, const std::string& name) {
  return parts_->kept([&] { return parts_->recognition.step(parts_->entry(e, "step"), name); });
}

SX Builder::sign(const SX& e, const std::string& name) {
  return parts_->kept([&] { return parts_->recognition.sign(parts_->entry(e, "sign"), name); });
}

SX Builder::abs(const SX& e, const std::string& name) {
  return parts_->kept([&] { return parts_->recognition.abs(parts_->entry(e, "abs"), name); });
}

SX Builder::max(const SX& a, const SX& b, const std::string& name) {
  return parts_->kept([&] { return parts_->recognition.max(parts_->entry(a, "max"), parts_->entry(b, "max"), name); });
}

SX Builder::min(const SX& a, const SX& b, const std::string& name) {
  return parts_->kept([&] { return parts_->recognition.min(parts_->entry(a, "min"), parts_->entry(b, "min"), name); });
}

SX Builder::if_(const Condition& condition, const SX& a, const SX& b) {
  return parts_->kept(
      [&] { return parts_->recognition.select(condition, parts_->entry(a, "if"), parts_->entry(b, "if")); });
}

SX Builder::floor(const SX& e) {
  return parts_->kept(
      [&] { return parts_->recognition.floor(parts_->entry(e, "floor"), fmt::format("floor({})", e.get_str())); });
}

SX Builder::mod(const SX& e, const SX& m) {
  return parts_->kept([&] {
    const std::string name = fmt::format("mod({},{})", e.get_str(), m.get_str());
    return parts_->recognition.mod(parts_->entry(e, "mod"), parts_->entry(m, "mod"), name);
  });
}

std::function<SX(const SX&)> Builder::table(const std::string& name, const std::vector<double>& x,
                                            const std::vector<double>& y, TableKind kind) {
  std::shared_ptr<const CellTable> cells;
  if (parts_->declare(name, NameKind::table, 0))
    cells = parts_->cells("table", name, find_mistake(x, y, kind), [&] { return table_cells(x, y, kind); });
  return [parts = parts_.get(), cells, name](const SX& e) {
    if (!cells) return SX(0.0);
    return parts->kept([&] {
      return parts->recognition.lookup(cells, parts->entry(e, name), fmt::format("{}({})", name, e.get_str()));
    });
  };
}

void Builder::dynamics(const std::string& state, const SX& rate) {
  const SXElem e = parts_->entry(rate, "dynamics of " + state);
  auto* entry = parts_->find(parts_->statement.states, state, NameKind::state);
  if (entry == nullptr) return;
  if (entry->dynamics) {
    parts_->refuse(fmt::format("the state '{}' has two right-hand sides", state), "keep one of them, or add their sum");
  }
  entry->dynamics = e;
}

void Builder::mechanics(const Mechanics& mechanics) {
  if (parts_->mechanics) {
    parts_->refuse("mechanics() was called twice", "state one mechanical system");
    return;
  }
  MechanicsStatement stated{.mass = mechanics.mass,
                            .potential = parts_->entry(mechanics.potential, "potential"),
                            .coriolis = mechanics.coriolis};
  for (const auto& [names, numbers] :
       {std::pair{&mechanics.positions, &stated.positions}, std::pair{&mechanics.velocities, &stated.velocities}}) {
    for (const auto& name : *names) {
      const auto* state = parts_->find(parts_->statement.states, name, NameKind::state);
      if (state == nullptr) return;
      numbers->push_back(static_cast<int>(state - parts_->statement.states.data()));
    }
  }
  const auto n = static_cast<casadi_int>(stated.positions.size());
  if (mechanics.mass.is_empty()) stated.mass = SX::eye(n);
  if (stated.velocities.size() != stated.positions.size() || stated.mass.size1() != n || stated.mass.size2() != n) {
    parts_->refuse(fmt::format("{} positions, {} velocities and a mass matrix of {} x {}", n, stated.velocities.size(),
                               stated.mass.size1(), stated.mass.size2()),
                   "every position has a velocity, and the mass matrix a row and a column for each");
    return;
  }
  stated.force = SX::zeros(n, 1);
  for (const auto& [name, force] : mechanics.force) {
    const auto place = std::find(mechanics.velocities.begin(), mechanics.velocities.end(), name);
    if (place == mechanics.velocities.end()) {
      parts_->fail({ErrorCode::unknown_name,
                    fmt::format("a force on '{}', which is no velocity", name),
                    suggest(name, mechanics.velocities),
                    {},
                    {}});
      return;
    }
    stated.force(place - mechanics.velocities.begin()) = parts_->entry(force, "force on " + name);
  }
  if (!parts_->take_drawing(mechanics.draw, stated)) return;
  parts_->mechanics = std::move(stated);
}

void Builder::contact(const std::string& name, const SX& gap, const ContactOptions& options) {
  if (!parts_->declare(name, NameKind::contact, parts_->contacts.size())) return;
  parts_->gaps.push_back(SX(parts_->entry(gap, "gap of " + name)));
  parts_->contacts.emplace_back(name, options);
}

void Builder::time_freezing(const FreezingNumbers& numbers) {
  if (const auto mistake = find_mistake(numbers)) parts_->fail(*mistake);
  parts_->freezing = numbers;
}

void Builder::mode(const Condition& when, const std::map<std::string, SX>& rates, const std::string& group) {
  parts_->add_mode({.when = when}, rates, group);
}

void Builder::otherwise(const std::map<std::string, SX>& rates, const std::string& group) {
  parts_->add_mode({}, rates, group);
}

void Builder::region(const SX& indicator, const std::map<std::string, SX>& rates, const std::string& name,
                     const std::string& group) {
  ModeStatement mode{.indicator = parts_->entry(indicator, "an indicator"), .name = name};
  parts_->add_mode(std::move(mode), rates, group);
}

void Builder::output(const std::string& name, const SX& expression) {
  auto& outputs = parts_->statement.outputs;
  if (!parts_->declare(name, NameKind::output, outputs.size())) return;
  outputs.push_back({name, parts_->entry(expression, "output " + name)});
}

void Builder::event(const SX& expression, const EventOptions& options) {
  auto& events = parts_->statement.events;
  const std::string name = options.name.value_or(fmt::format("event{}", events.size() + 1));
  if (!parts_->declare(name, NameKind::event, events.size())) return;
  events.push_back({.name = options.name,
                    .expression = parts_->entry(expression, "event " + name),
                    .direction = options.direction,
                    .action = options.action});
}

void Builder::event(const Condition& condition, const EventOptions& options) {
  auto& events = parts_->statement.events;
  const std::string name = options.name.value_or(fmt::format("event{}", events.size() + 1));
  if (!parts_->declare(name, NameKind::event, events.size())) return;
  events.push_back(
      {.name = options.name, .condition = condition, .direction = options.direction, .action = options.action});
}

void Builder::jump(const Condition& when, const std::map<std::string, SX>& set, const JumpOptions& options) {
  if (auto* jump = parts_->add_jump(set, options)) jump->condition = when;
}

void Builder::jump(const SX& guard, Direction direction, const std::map<std::string, SX>& set,
                   const JumpOptions& options) {
  auto* jump = parts_->add_jump(set, options);
  if (jump == nullptr) return;
  jump->guard = parts_->entry(guard, "guard of a jump");
  switch (direction) {
    case Direction::down:
      jump->trigger = JumpTrigger::guard_down;
      break;
    case Direction::up:
      jump->trigger = JumpTrigger::guard_up;
      break;
    case Direction::both:
      jump->trigger = JumpTrigger::guard_both;
      break;
  }
}

void Builder::jump_at(const std::vector<double>& times, const std::map<std::string, SX>& set,
                      const JumpOptions& options) {
  auto* jump = parts_->add_jump(set, options);
  if (jump == nullptr) return;
  jump->trigger = JumpTrigger::times;
  for (const double time : times) jump->times.push_back({.value = time});
}

void Builder::jump_every(double period, const std::map<std::string, SX>& set, const JumpOptions& options) {
  auto* jump = parts_->add_jump(set, options);
  if (jump == nullptr) return;
  jump->trigger = JumpTrigger::times;
  jump->every = period;
}

void Builder::input(const std::string& control, const SX& expression) {
  const SXElem e = parts_->entry(expression, "input of " + control);
  if (auto* entry = parts_->find(parts_->statement.controls, control, NameKind::control)) entry->input = e;
}

void Builder::input(const std::string& control, const std::vector<double>& times, const std::vector<double>& values) {
  auto* entry = parts_->find(parts_->statement.controls, control, NameKind::control);
  if (entry == nullptr) return;
  const auto cells =
      parts_->cells("input", control, find_mistake(times, values), [&] { return step_cells(times, values); });
  if (!cells) return;
  entry->input =
      parts_->kept([&] { return parts_->recognition.lookup(cells, parts_->statement.time, control); }).scalar();
}

Expected<System> Builder::build() {
  if (parts_->error) return tl::unexpected(*parts_->error);
  auto system = guarded([&] { return parts_->physical(); });
  if (!system || (!parts_->stands_still() && system->contacts.empty())) return system;
  // Of the model as it is stated by now, whatever is added to it later.
  system->frozen = std::make_shared<const FrozenSystem>([parts = std::make_shared<Parts>(*parts_)] {
    return guarded([&] { return parts->stands_still() ? parts->frozen(FrozenFor::simulation) : parts->as_written(); });
  });
  return system;
}

}  // namespace saltus::model
