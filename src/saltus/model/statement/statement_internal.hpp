// Everything a model states, in CasADi expressions, before it is made a System.
#pragma once

#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "saltus/model/recognition/recognition_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Holds the lower and upper bound; infinite if absent.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct ParameterStatement {
  std::string name;
  SXElem symbol;
  double value = 0.0;
};

struct StateStatement {
  std::string name;
  SXElem symbol;
  double initial = 0.0;
  Bounds bounds{};
  std::optional<SXElem> dynamics{};
  SourceLocation location{};  ///< of its declaration
  SourceLocation dynamics_location{};
};

struct ControlStatement {
  std::string name;
  SXElem symbol;
  double initial = 0.0;
  Bounds bounds{};
  std::optional<SXElem> input{};
  SourceLocation location{};
  SourceLocation input_location{};
};

struct OutputStatement {
  std::string name;
  SXElem expression;
};

/// Holds either an expression (its zeros) or a condition (its edges).
struct EventStatement {
  std::optional<std::string> name;
  std::optional<SXElem> expression{};
  std::optional<Condition> condition{};
  Direction direction = Direction::both;
  AtEvent action = AtEvent::record;
  SourceLocation location{};
};

/// Holds the state number `state` <- value.
struct AssignmentStatement {
  int state = 0;
  SXElem value;
  SourceLocation location{};
};

struct TimeStatement {
  double value = 0.0;
  SourceLocation location{};
};

/// Holds a jump by its trigger: a condition, a guard, or times.
struct JumpStatement {
  std::optional<std::string> name{};
  JumpTrigger trigger = JumpTrigger::condition;
  std::optional<Condition> condition{};
  std::optional<SXElem> guard{};
  std::vector<TimeStatement> times{};
  double every = 0.0;
  std::vector<AssignmentStatement> set{};
  SXElem priority = 0.0;
  SXElem delay = 0.0;
  bool at_start = false;
  bool persistent = true;
  std::optional<JumpValues> evaluated{};  ///< absent: at the trigger
  std::string forbidden{};                ///< what its trigger means where that stops the run instead; else empty
  SourceLocation location{};
  SourceLocation when_location{};  ///< of the condition, guard or period
  SourceLocation delay_location{};
};

struct SwitchingStatement {
  DeclaredFunction declared;
  SourceLocation location{};
  bool referenced = false;  ///< by its name
};

/// Holds what a mode adds to the right-hand side of state number `state`.
struct ModeRate {
  int state = 0;
  SXElem rate;
  SourceLocation location{};
};

struct ModeStatement {
  std::optional<Condition> when{};  ///< absent: otherwise, or by indicator
  std::optional<SXElem> indicator{};
  std::string name{};  ///< with an indicator
  std::vector<ModeRate> rates{};
  SourceLocation location{};
};

struct ModeGroupStatement {
  std::string name;
  std::vector<ModeStatement> modes;
  [[nodiscard]] bool by_indicator() const { return modes.front().indicator.has_value(); }
};

struct Statement {
  std::string name;
  std::string description;
  Inclusion inclusion = Inclusion::filippov;
  SXElem time;
  std::vector<ParameterStatement> parameters;
  std::vector<StateStatement> states;
  std::vector<ControlStatement> controls;
  std::vector<SwitchingStatement> switching;  ///< in the order of the file
  std::vector<ModeGroupStatement> mode_groups;
  std::vector<OutputStatement> outputs;
  std::vector<EventStatement> events;
  std::vector<JumpStatement> jumps;
  ContactSystem contacts;
  std::vector<DrawnShape> drawing;
  std::vector<MassPivot> mass_pivots;
  std::vector<OutputStatement> automatic_outputs;  ///< behind the others
  std::vector<std::string> warnings;
};

/// Classifies the switching functions, reduces the right-hand side, drops what nothing uses and numbers the rest.
/// @return the system, or an error: no states, a state without dynamics, values that are not finite, a right-hand side
///         whose interpolation has too many corners.
[[nodiscard]] Expected<System> assemble(Recognition& recognition, const Statement& statement);

[[nodiscard]] Error no_right_hand_side(const std::string& state, const SourceLocation& location);

/// Refuses an initial value that is not finite and bounds that exclude each other; warns where the value lies outside.
/// @param what  "state 'q'"
[[nodiscard]] std::optional<Error> check_values(const std::string& what, double initial, const Bounds& bounds,
                                                const SourceLocation& location, std::vector<std::string>& warnings);

/// Returns the error with this place, unless it says one itself.
[[nodiscard]] inline Error with_location(Error error, const SourceLocation& location) {
  if (error.location.line == 0) error.location = location;
  return error;
}

/// Returns "file:line: text", as far as the place is known.
[[nodiscard]] std::string located(const SourceLocation& location, const std::string& text);

}  // namespace saltus::model
