#include "saltus/model/builder.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/model/hysteresis/hysteresis_internal.hpp"
#include "saltus/model/mechanics/mechanics_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"
#include "saltus/model/statement/names_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"
#include "saltus/model/written_friction_internal.hpp"

namespace saltus::model {

using casadi::SX;

struct Builder::Parts {
  Recognition recognition;
  Statement statement;
  NameTable names;
  std::optional<MechanicsStatement> mechanics;
  std::vector<std::pair<std::string, ContactOptions>> contacts;
  std::vector<SX> gaps;
  std::optional<Error> error;

  void fail(Error mistake) {
    if (!error) error = std::move(mistake);
  }

  void refuse(std::string message, std::string remedy) {
    fail({ErrorCode::invalid_model, std::move(message), std::move(remedy), {}, {}});
  }

  bool declare(const std::string& name, NameKind kind, std::size_t index) {
    auto mistake = names.declare(name, {kind, static_cast<int>(index), {}});
    if (mistake) fail(*mistake);
    return !mistake;
  }

  /// Declares what has a clock of its own.
  bool declare_with_clock(const std::string& name, NameKind kind, std::size_t index, const std::string& call) {
    auto mistake = names.reserve_clock(call);
    if (mistake) fail(*mistake);
    return !mistake && declare(name, kind, index);
  }

  SXElem entry(const SX& expression, const std::string& where) {
    if (const auto e = scalar(expression)) return *e;
    refuse(fmt::format("{}: expected a scalar, found a {} x {} matrix", where, expression.size1(), expression.size2()),
           "state the entries one by one");
    return SXElem(0.0);
  }

  /// The result of a recognition, or 0 and the mistake kept. Nothing is tried after the first one.
  SX kept(FunctionRef<Expected<SXElem>()> recognise) {
    if (error) return SX(0.0);
    try {
      auto result = recognise();
      if (result) return SX(*result);
      fail(result.error());
    } catch (const std::exception& exception) {
      refuse(fmt::format("CasADi refused an expression: {}", exception.what()), "");
    }
    return SX(0.0);
  }

  SX symbol(const std::string& name, const Variable& variable) { return SX(recognition.graph.symbol(name, variable)); }

  void add_state(const std::string& name, const Values& values, VariableKind kind) {
    auto& states = statement.states;
    const Bounds bounds{values.lower, values.upper};
    if (auto mistake = check_values(fmt::format("state '{}'", name), values.initial, bounds, {}, statement.warnings)) {
      fail(*mistake);
    }
    const SX made = symbol(name, {.kind = kind, .index = static_cast<int>(states.size()), .value = values.initial});
    states.push_back({.name = name, .symbol = made.scalar(), .initial = values.initial, .bounds = bounds});
    if (kind == VariableKind::discrete) states.back().dynamics = SXElem(0.0);
  }

  /// A jump without its trigger; null after a mistake.
  JumpStatement* add_jump(const std::map<std::string, SX>& set, const JumpOptions& options) {
    auto& jumps = statement.jumps;
    const std::string name = options.name.value_or(fmt::format("jump{}", jumps.size() + 1));
    if (!declare(name, NameKind::jump, jumps.size())) return nullptr;
    JumpStatement jump{.name = options.name};
    for (const auto& [state, value] : set) {
      const auto* target = find(statement.states, state, NameKind::state);
      if (target == nullptr) return nullptr;
      const auto index = static_cast<int>(target - statement.states.data());
      jump.set.push_back({.state = index, .value = entry(value, fmt::format("jump {}, {}", name, state))});
    }
    jump.priority = entry(options.priority, "priority of " + name);
    jump.delay = entry(options.delay, "delay of " + name);
    jump.at_start = options.at_start;
    jump.persistent = options.persistent;
    jump.evaluated = options.values;
    jumps.push_back(std::move(jump));
    return &jumps.back();
  }

  void add_mode(ModeStatement mode, const std::map<std::string, SX>& rates, const std::string& group) {
    for (const auto& [name, rate] : rates) {
      const auto* state = find(statement.states, name, NameKind::state);
      if (state == nullptr) return;
      const auto index = static_cast<int>(state - statement.states.data());
      mode.rates.push_back({.state = index, .rate = entry(rate, "a mode's dynamics of " + name)});
    }
    auto& groups = statement.mode_groups;
    auto known = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.name == group; });
    if (known == groups.end()) known = groups.insert(groups.end(), {group, {}});
    if (mode.indicator && mode.name.empty()) mode.name = fmt::format("mode{}", known->modes.size() + 1);
    for (const auto& other : known->modes) {
      if (other.indicator.has_value() != mode.indicator.has_value()) {
        refuse(fmt::format("the group '{}' has modes with conditions and regions by indicator", group),
               "give all modes of a group the same form, or another group");
      } else if (mode.indicator && other.name == mode.name) {
        refuse(fmt::format("two modes are named '{}'", mode.name), "rename one of them");
      }
    }
    known->modes.push_back(std::move(mode));
  }

  /// @return false after a mistake
  bool take_drawing(const std::vector<DrawnShape>& shapes, MechanicsStatement& stated) {
    for (const auto& [points, radius] : shapes) {
      const bool is_disc = !radius.is_empty();
      if (points.size1() != 2 || points.size2() < 1 || is_disc != (points.size2() == 1)) {
        refuse(fmt::format("what is drawn has {} coordinates", points.dim()),
               "a line has 2 x n coordinates, n >= 2, and no radius; a disc 2 x 1 and a radius");
        return false;
      }
      DrawnStatement drawn{.shape = {SX::densify(points), SX()}};
      for (SXElem& e : drawn.shape.points.nonzeros()) e = entry(SX(e), "what is drawn");
      if (is_disc) drawn.shape.radius = SX(entry(radius, "the radius of what is drawn"));
      stated.draw.push_back(std::move(drawn));
    }
    return true;
  }

  std::optional<Error> add_mechanics(Statement& whole) {
    if (!mechanics && contacts.empty()) return std::nullopt;
    if (!mechanics) return Error{ErrorCode::invalid_model, "contacts without mechanics()", "call mechanics()", {}, {}};
    MechanicsStatement stated = *mechanics;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto& [name, options] = contacts[i];
      ContactStatement contact{.name = name, .gap = gaps[i]};
      contact.friction = entry(options.friction, "friction of " + name);
      contact.restitution = entry(options.restitution, "restitution of " + name);
      for (const auto* tangent : {&options.tangent, &options.second_tangent}) {
        if (tangent->empty()) continue;
        SX row = SX::zeros(1, static_cast<casadi_int>(stated.positions.size()));
        for (const auto& [position, value] : *tangent) {
          const auto place =
              std::find_if(stated.positions.begin(), stated.positions.end(),
                           [&, &wanted = position](int state) { return whole.states[at(state)].name == wanted; });
          if (place == stated.positions.end()) {
            return Error{ErrorCode::unknown_name,
                         fmt::format("the tangent of '{}' has the entry '{}', which is no position", name, position),
                         "a tangent is a row over the positions",
                         {},
                         {}};
          }
          row(0, place - stated.positions.begin()) = entry(value, "tangent of " + name);
        }
        contact.tangents = contact.tangents.is_empty() ? row : SX::vertcat({contact.tangents, row});
      }
      stated.contacts.push_back(std::move(contact));
    }
    return state_mechanics(recognition, whole, stated);
  }

  /// The cells of points without mistake; null with the mistake kept.
  std::shared_ptr<const CellTable> cells(const std::string& kind, const std::string& name,
                                         const std::optional<PointMistake>& mistake, FunctionRef<CellTable()> make) {
    if (!mistake) return std::make_shared<const CellTable>(make());
    const std::string point = mistake->point ? fmt::format(", point {}", *mistake->point + 1) : "";
    refuse(fmt::format("{} '{}'{}: {}", kind, name, point, mistake->message), mistake->remedy);
    return nullptr;
  }

  template <class Entries>
  typename Entries::value_type* find(Entries& entries, const std::string& name, NameKind kind) {
    const Meaning* meaning = names.find(name);
    if (meaning != nullptr && meaning->kind == kind) return &entries[at(meaning->index)];
    fail({ErrorCode::unknown_name,
          fmt::format("'{}' is not {} of this model", name, with_article(kind)),
          suggest(name, names.of({kind})),
          {},
          {}});
    return nullptr;
  }
};

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
  if (!parts_->declare_with_clock(name, NameKind::hysteresis, states.size(), "hysteresis()")) return SX(0.0);
  const SXElem e = parts_->entry(input, "input of " + name);
  parts_->add_state(name, {.initial = values.initial}, VariableKind::discrete);
  const auto state = static_cast<int>(states.size()) - 1;
  if (auto error = state_hysteresis(parts_->recognition, parts_->statement, state, e,
                                    {name, values.on, values.off, values.initial, {}})) {
    parts_->fail(*error);
  }
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
  if (!parts_->declare_with_clock(name, NameKind::contact, parts_->contacts.size(), "contact()")) return;
  parts_->gaps.push_back(SX(parts_->entry(gap, "gap of " + name)));
  parts_->contacts.emplace_back(name, options);
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
  try {
    Statement statement = parts_->statement;  // more may be stated later
    if (auto error = add_modes(parts_->recognition, statement)) return tl::unexpected(*error);
    if (auto error = parts_->add_mechanics(statement)) return tl::unexpected(*error);
    state_written_friction(parts_->recognition, statement);
    return assemble(parts_->recognition, statement);
  } catch (const std::exception& exception) {
    return tl::unexpected(
        Error{ErrorCode::invalid_model, fmt::format("CasADi refused the model: {}", exception.what()), "", {}, {}});
  }
}

}  // namespace saltus::model
