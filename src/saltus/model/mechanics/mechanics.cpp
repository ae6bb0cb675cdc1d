#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/mechanics/contacts_internal.hpp"
#include "saltus/model/mechanics/smooth_check_internal.hpp"
#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"
#include "saltus/model/statement/start_values_internal.hpp"

namespace saltus::model {

using casadi::SX;

bool is_mechanical(const Description& description, const std::string& name) {
  if (!description.mechanics) return false;
  const auto lists = [&](const std::vector<StateName>& names) {
    return std::any_of(names.begin(), names.end(), [&](const StateName& entry) { return entry.name == name; });
  };
  return lists(description.mechanics->positions) || lists(description.mechanics->velocities);
}

namespace {

Error mechanics_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {"in [mechanics]"}};
}

/// Entries below the diagonal with those above it, where one of them is not 0 by its form, by row and column.
using Pairs = std::map<std::pair<casadi_int, casadi_int>, std::array<SXElem, 2>>;

Pairs pairs_of(const SX& matrix) {
  Pairs pairs;
  const auto rows = matrix.sparsity().get_row(), columns = matrix.sparsity().get_col();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const casadi_int i = rows[k], j = columns[k];
    if (i == j || matrix.nonzeros()[k].is_zero()) continue;
    auto& pair = pairs.try_emplace({std::max(i, j), std::min(i, j)}, std::array<SXElem, 2>{0.0, 0.0}).first->second;
    pair[i > j ? 0 : 1] = matrix.nonzeros()[k];
  }
  return pairs;
}

class MechanicsBuild {
 public:
  MechanicsBuild(Recognition& recognition, Statement& statement, const MechanicsStatement& mechanics,
                 const StateContacts& contacts)
      : recognition_(recognition),
        statement_(statement),
        mechanics_(mechanics),
        contacts_(contacts),
        q_(symbols_of(statement, mechanics.positions)),
        v_(symbols_of(statement, mechanics.velocities)) {}

  [[nodiscard]] std::optional<Error> run() {
    if (auto error = check_free_of_dynamics()) return error;
    for (const SXElem& e : mechanics_.mass.nonzeros()) {
      if (auto error = check_reach(e, "the mass matrix", mechanics_.mass_location)) return error;
    }
    if (auto error = check_reach(mechanics_.potential.scalar(), "the potential", mechanics_.potential_location)) {
      return error;
    }
    if (auto error = check_symmetry()) return error;
    if (auto error = take_drawing()) return error;
    const SymbolicLdl factors(mechanics_.mass, q_);
    if (auto error = check_definite(factors.pivots())) return error;
    if (auto error = note_pivots(factors.pivots())) return error;
    SX force = total_force();
    if (!mechanics_.contacts.empty()) {
      const MotionWithoutContacts motion{mechanics_.positions, mechanics_.velocities, factors, force};
      auto with_contacts = contacts_ ? contacts_(mechanics_.contacts, motion)
                                     : add_contacts(recognition_, statement_, mechanics_.contacts, motion);
      if (!with_contacts) return with_contacts.error();
      force = *with_contacts;
    }
    set_dynamics(factors.accelerations(force));
    const SX kinetic = SX::mtimes(v_.T(), SX::mtimes(mechanics_.mass, v_)) / 2.0;
    if (!is_taken("energy")) {
      statement_.automatic_outputs.push_back({"energy", SX::densify(kinetic + mechanics_.potential).scalar()});
    }
    return std::nullopt;
  }

 private:
  /// Columns of results have the names of states, controls and outputs.
  [[nodiscard]] bool is_taken(std::string_view name) const {
    const auto in = [&](const auto& stated) {
      return std::any_of(stated.begin(), stated.end(), [&](const auto& entry) { return entry.name == name; });
    };
    return in(statement_.states) || in(statement_.controls) || in(statement_.outputs);
  }

  [[nodiscard]] std::optional<Error> check_reach(const SXElem& expression, const std::string& what,
                                                 const SourceLocation& location) {
    const auto node = recognition_.graph.add(expression);
    if (!node) return with_location(node.error(), location);
    return check_smooth(recognition_, statement_, *node, {mechanics_.positions, false, what, location});
  }

  [[nodiscard]] const std::string& name_of(int state) const { return statement_.states[at(state)].name; }

  [[nodiscard]] std::optional<Error> check_free_of_dynamics() const {
    for (const auto& [states, what, rate] : {std::tuple{&mechanics_.positions, "position", "its velocity"},
                                             std::tuple{&mechanics_.velocities, "velocity", "given by `force`"}}) {
      for (const int state : *states) {
        const auto place = place_of_dynamics(state);
        if (!place) continue;
        return mechanics_error(
            *place, fmt::format("'{}' is a {} of [mechanics] and has a right-hand side, too", name_of(state), what),
            fmt::format("remove it: its rate is {}", rate));
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<SourceLocation> place_of_dynamics(int state) const {
    if (statement_.states[at(state)].dynamics) return statement_.states[at(state)].dynamics_location;
    for (const auto& group : statement_.mode_groups) {
      for (const auto& mode : group.modes) {
        for (const auto& rate : mode.rates) {
          if (rate.state == state) return rate.location;
        }
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] Expected<double> at_start(const SXElem& expression, double moved = 0.0) {
    return recognition_.graph.add(expression).map([&](int node) {
      return value_at_start(recognition_, statement_, node, moved);
    });
  }

  [[nodiscard]] std::optional<Error> check_symmetry() {
    for (const auto& [place, entries] : pairs_of(mechanics_.mass)) {
      const auto& [below, above] = entries;
      if (SXElem::is_equal(below, above, 0) && below.is_constant()) continue;
      // Positions that are 0 at the start hide what they are factors of.
      for (const double moved : {0.0, 0.3, -0.2}) {
        if (auto error = check_equal(place.first, place.second, entries, moved)) return error;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> check_equal(casadi_int i, casadi_int j, const std::array<SXElem, 2>& entries,
                                                 double moved) {
    const auto below = at_start(entries[0], moved), above = at_start(entries[1], moved);
    if (!below) return below.error();
    if (!above) return above.error();
    if (moved != 0.0 && !std::isfinite(*below - *above)) return std::nullopt;
    // Rounding of two ways to write the same expression.
    if (std::abs(*below - *above) <= 1e-12 * std::max(std::abs(*below), std::abs(*above))) return std::nullopt;
    return mechanics_error(
        mechanics_.mass_location,
        fmt::format("the mass matrix is not symmetric: row {}, column {} is {}, row {}, column {} is {} {} the start",
                    i + 1, j + 1, *below, j + 1, i + 1, *above, moved == 0.0 ? "at" : "near"),
        "write the same expression in both places");
  }

  [[nodiscard]] std::optional<Error> check_definite(const std::vector<SXElem>& pivots) {
    const auto diagonals = SX::densify(SX::diag(mechanics_.mass)).nonzeros();
    for (std::size_t i = 0; i < pivots.size(); ++i) {
      const auto pivot = at_start(pivots[i]);
      if (!pivot) return pivot.error();
      const auto diagonal = at_start(diagonals[i]);
      // What is left of a diagonal entry that the rows above determine is their rounding.
      if (*pivot > 1e-13 * std::abs(*diagonal) && std::isfinite(*pivot)) continue;
      return mechanics_error(
          mechanics_.mass_location,
          fmt::format("the mass matrix is not positive definite at the start: row {} ('{}') depends on the rows above, "
                      "or has no positive mass (pivot {})",
                      i + 1, name_of(mechanics_.velocities[i]), *pivot),
          "every velocity needs a positive mass or inertia of its own");
    }
    return std::nullopt;
  }

  /// Those that may become negative on the way.
  [[nodiscard]] std::optional<Error> note_pivots(const std::vector<SXElem>& pivots) {
    constexpr KindSet states = kind_bit(VariableKind::state) | kind_bit(VariableKind::discrete);
    for (std::size_t i = 0; i < pivots.size(); ++i) {
      const auto node = recognition_.graph.add(pivots[i]);
      if (!node) return with_location(node.error(), mechanics_.mass_location);
      if ((recognition_.graph.tape()[*node].written & states) == 0) continue;
      statement_.mass_pivots.push_back({static_cast<int>(i), mechanics_.velocities[i], *node});
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> take_drawing() {
    for (const auto& [shape, location] : mechanics_.draw) {
      const SX points = SX::densify(shape.points);
      for (const SXElem& e : points.nonzeros()) {
        if (auto error = check_reach(e, "what is drawn", location)) return error;
      }
      if (!shape.radius.is_empty()) {
        if (auto error = check_radius(shape.radius.scalar(), location)) return error;
      }
      statement_.drawing.push_back(shape);
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> check_radius(const SXElem& radius, const SourceLocation& location) {
    if (auto error = check_reach(radius, "the radius of what is drawn", location)) return error;
    const auto value = at_start(radius);
    if (!value) return value.error();
    if (*value > 0.0 && std::isfinite(*value)) return std::nullopt;
    return mechanics_error(location, fmt::format("the radius of a disc that is drawn is {} at the start", *value),
                           "it is a length > 0");
  }

  [[nodiscard]] SX total_force() const {
    SX force = mechanics_.force - SX::gradient(mechanics_.potential, q_);
    if (mechanics_.coriolis == Coriolis::in_force) return force;
    const SX momentum = SX::mtimes(mechanics_.mass, v_);
    const SX kinetic = SX::mtimes(v_.T(), momentum) / 2.0;
    return force - SX::mtimes(SX::jacobian(momentum, q_), v_) + SX::gradient(kinetic, q_);
  }

  void set_dynamics(const SX& acceleration) {
    for (std::size_t i = 0; i < mechanics_.positions.size(); ++i) {
      auto& position = statement_.states[at(mechanics_.positions[i])];
      auto& velocity = statement_.states[at(mechanics_.velocities[i])];
      position.dynamics = velocity.symbol;
      velocity.dynamics = SX(acceleration(static_cast<casadi_int>(i))).scalar();
      position.dynamics_location = velocity.dynamics_location = mechanics_.location;
    }
  }

  Recognition& recognition_;
  Statement& statement_;
  const MechanicsStatement& mechanics_;
  const StateContacts& contacts_;
  SX q_, v_;
};

}  // namespace

SX symbols_of(const Statement& statement, const std::vector<int>& states) {
  std::vector<SXElem> symbols;
  for (const int state : states) symbols.push_back(statement.states[at(state)].symbol);
  return column(symbols);
}

std::optional<Error> state_mechanics(Recognition& recognition, Statement& statement,
                                     const MechanicsStatement& mechanics, const StateContacts& contacts) {
  return MechanicsBuild(recognition, statement, mechanics, contacts).run();
}

}  // namespace saltus::model
