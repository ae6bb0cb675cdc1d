// What of a System is no expression: names, roles, and which of its parts belong together.
#pragma once

#include <string>
#include <vector>

#include "saltus/model/mechanics/contact.hpp"
#include "saltus/model/roles.hpp"

namespace saltus::model {

/// Holds a column of the result: a switching function, or an alias of one (the same surface named twice).
struct SwitchingColumn {
  std::string name;
  int function = 0;      ///< index into System::switching
  int orientation = +1;  ///< -1 if this name's psi is a negative multiple of the function's
};

/// Holds of a System what is no expression. layout_of() fills it; a compiled model adds what only it knows: numbers of
/// event functions, which guards are discrete, and what these read. Values of parameters change `times` and `every` of
/// jumps; initial states are not in it.
struct Layout {
  /// Holds a switching function.
  struct Surface {
    std::string name;
    SwitchingRole role = SwitchingRole::listed;
    bool is_kink = false;        ///< SwitchingFunction::is_kink(): nothing jumps on it
    bool continuous = false;     ///< listed, though nothing jumps on it
    double alpha_at_zero = 0.5;  ///< role discrete: alpha where psi is 0, as written
    std::vector<int> states{};   ///< role discrete: those that psi reads, ascending; of a compiled model
    bool named = false;          ///< declared in [switching]
  };
  /// Holds a comparison in a condition, or a guard.
  struct Guard {
    int function = -1;  ///< event function; of a compiled model
    /// It depends on discrete states and constants only: jumps alone change it. Of a compiled model.
    bool discrete = false;
    bool true_at_equality = false;  ///< step(guard) counts as 1 where the guard is 0
    std::vector<int> states{};      ///< of a discrete one: those that it reads, ascending; of a compiled model
  };
  struct Jump {
    std::string name;
    JumpTrigger trigger = JumpTrigger::condition;
    std::vector<Guard> guards;
    std::vector<double> times;  ///< ascending
    double every = 0.0;         ///< period from the start; 0 without
    std::vector<int> targets;   ///< states that are set
    bool at_start = false, persistent = true;
    JumpValues evaluated = JumpValues::at_trigger;
    std::string forbidden;  ///< what its trigger means where that stops the run instead; else empty
  };
  struct Event {
    std::string name;
    bool named = false;
    std::vector<Guard> guards;  ///< of a condition; empty for an expression
    Direction direction = Direction::both;
    AtEvent action = AtEvent::record;

    [[nodiscard]] bool is_condition() const { return !guards.empty(); }
  };
  /// Holds a group of [[modes]].
  struct Group {
    std::string name;
    int regions = 0;
    int first = -1;                       ///< by `indicator`: its first surface
    std::vector<std::string> mode_names;  ///< by `indicator`
  };

  std::string name;
  std::vector<std::string> state_names, control_names, parameter_names, output_names, cell_names;
  std::vector<bool> discrete_states;  ///< dynamics 0, changed by jumps only
  std::vector<Surface> surfaces;
  std::vector<SwitchingColumn> columns;  ///< of the result
  std::vector<Event> events;
  std::vector<Jump> jumps;
  std::vector<Group> groups;
  std::vector<Contact> contacts;
  std::vector<int> positions, velocities;  ///< states of bodies with contacts
  Inclusion inclusion = Inclusion::filippov;
  bool multi_affine = true;          ///< System::multi_affine
  bool affine_in_selections = true;  ///< f is affine in each selection
};

}  // namespace saltus::model
