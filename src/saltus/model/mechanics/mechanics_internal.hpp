// [mechanics] becomes right-hand sides, [[contacts]] with it.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"

namespace saltus::model {

/// Returns whether a state is a position or a velocity of [mechanics].
[[nodiscard]] bool is_mechanical(const Description& description, const std::string& name);

/// Holds one contact in expressions of the statement it belongs to.
struct ContactStatement {
  std::string name;
  casadi::SX gap{};
  casadi::SX tangents{};  ///< 1 x n or 2 x n over the positions; 0 x 0 without
  casadi::SX friction = 0.0, restitution = 0.0;
  SourceLocation location{}, gap_location{}, tangent_location{}, friction_location{}, restitution_location{};
};

/// Holds what is drawn, and where it is written.
struct DrawnStatement {
  DrawnShape shape;
  SourceLocation location{};
};

/// Holds a mechanical system in expressions of the statement it belongs to.
struct MechanicsStatement {
  std::vector<int> positions{}, velocities{};  ///< states, in the same order
  casadi::SX mass{};                           ///< n x n
  casadi::SX potential = 0.0;
  casadi::SX force{};  ///< n
  Coriolis coriolis = Coriolis::in_force;
  std::vector<ContactStatement> contacts{};
  std::vector<DrawnStatement> draw{};
  SourceLocation location{}, mass_location{}, potential_location{};
};

/// Returns the symbols of some states, as a column.
[[nodiscard]] casadi::SX symbols_of(const Statement& statement, const std::vector<int>& states);

/// Resolves [mechanics] and [[contacts]] of a description; nothing without.
[[nodiscard]] Expected<std::optional<MechanicsStatement>> mechanics_of(const Description& description,
                                                                       ModelScope& scope, const Statement& statement);

struct MotionWithoutContacts;

/// What becomes of contacts: the total force with theirs.
using StateContacts =
    std::function<Expected<casadi::SX>(const std::vector<ContactStatement>&, const MotionWithoutContacts&)>;

/// Gives positions and velocities their right-hand sides, dq/dt = v and dv/dt = M^-1 (force - grad potential -
/// coriolis + forces of contacts), and appends the outputs of the contacts and `energy`, v'M v/2 + potential. The
/// initial values of the states are known.
/// @param contacts  as they are for the event engine if empty
/// @return the mistake: a right-hand side that is there already; a mass matrix, a potential or a drawing that depends
///         on more than positions and parameters; a mass matrix that is not symmetric or not positive definite at the
///         start
[[nodiscard]] std::optional<Error> state_mechanics(Recognition& recognition, Statement& statement,
                                                   const MechanicsStatement& mechanics,
                                                   const StateContacts& contacts = {});

}  // namespace saltus::model
