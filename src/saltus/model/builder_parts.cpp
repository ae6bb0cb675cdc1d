#include <algorithm>

#include "saltus/model/builder_parts_internal.hpp"
#include "saltus/model/statement/modes_internal.hpp"
#include "saltus/model/written_friction_internal.hpp"

namespace saltus::model {

using casadi::SX;

SXElem Builder::Parts::entry(const SX& expression, const std::string& where) {
  if (const auto e = scalar(expression)) return *e;
  refuse(fmt::format("{}: expected a scalar, found a {} x {} matrix", where, expression.size1(), expression.size2()),
         "state the entries one by one");
  return SXElem(0.0);
}

SX Builder::Parts::kept(FunctionRef<Expected<SXElem>()> recognise) {
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

void Builder::Parts::add_state(const std::string& name, const Values& values, VariableKind kind) {
  auto& states = statement.states;
  const Bounds bounds{values.lower, values.upper};
  if (auto mistake = check_values(fmt::format("state '{}'", name), values.initial, bounds, {}, statement.warnings)) {
    fail(*mistake);
  }
  const SX made = symbol(name, {.kind = kind, .index = static_cast<int>(states.size()), .value = values.initial});
  states.push_back({.name = name, .symbol = made.scalar(), .initial = values.initial, .bounds = bounds});
  if (kind == VariableKind::discrete) states.back().dynamics = SXElem(0.0);
}

JumpStatement* Builder::Parts::add_jump(const std::map<std::string, SX>& set, const JumpOptions& options) {
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

void Builder::Parts::add_mode(ModeStatement mode, const std::map<std::string, SX>& rates, const std::string& group) {
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

bool Builder::Parts::take_drawing(const std::vector<DrawnShape>& shapes, MechanicsStatement& stated) {
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

std::shared_ptr<const CellTable> Builder::Parts::cells(const std::string& kind, const std::string& name,
                                                       const std::optional<PointMistake>& mistake,
                                                       FunctionRef<CellTable()> make) {
  if (!mistake) return std::make_shared<const CellTable>(make());
  const std::string point = mistake->point ? fmt::format(", point {}", *mistake->point + 1) : "";
  refuse(fmt::format("{} '{}'{}: {}", kind, name, point, mistake->message), mistake->remedy);
  return nullptr;
}

Expected<MechanicsStatement> Builder::Parts::mechanics_with_contacts(const Statement& whole) {
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
          return tl::unexpected(
              Error{ErrorCode::unknown_name,
                    fmt::format("the tangent of '{}' has the entry '{}', which is no position", name, position),
                    "a tangent is a row over the positions",
                    {},
                    {}});
        }
        row(0, place - stated.positions.begin()) = entry(value, "tangent of " + name);
      }
      contact.tangents = contact.tangents.is_empty() ? row : SX::vertcat({contact.tangents, row});
    }
    stated.contacts.push_back(std::move(contact));
  }
  if (error) return tl::unexpected(*error);
  return stated;
}

std::optional<Error> Builder::Parts::add_mechanics(Recognition& recognised, Statement& whole,
                                                   const StateContacts& take) {
  if (!mechanics && contacts.empty()) return std::nullopt;
  if (!mechanics) return Error{ErrorCode::invalid_model, "contacts without mechanics()", "call mechanics()", {}, {}};
  const auto stated = mechanics_with_contacts(whole);
  if (!stated) return stated.error();
  return state_mechanics(recognised, whole, *stated, take);
}

Expected<System> Builder::Parts::as_written() {
  Statement whole = statement;  // more may be stated later
  if (auto mistake = add_modes(recognition, whole)) return tl::unexpected(*mistake);
  if (auto mistake = add_mechanics(recognition, whole)) return tl::unexpected(*mistake);
  return assemble(recognition, whole);
}

Expected<System> Builder::Parts::physical() {
  Statement whole = statement;
  if (auto mistake = add_modes(recognition, whole)) return tl::unexpected(*mistake);
  if (auto mistake = add_mechanics(recognition, whole)) return tl::unexpected(*mistake);
  state_written_friction(recognition, whole);
  return assemble(recognition, whole);
}

Expected<System> guarded(FunctionRef<Expected<System>()> make) {
  try {
    return make();
  } catch (const std::exception& exception) {
    return tl::unexpected(
        Error{ErrorCode::invalid_model, fmt::format("CasADi refused the model: {}", exception.what()), "", {}, {}});
  }
}

}  // namespace saltus::model
