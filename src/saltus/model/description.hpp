// What the user states, as syntax trees with positions: the value between a model file and a System.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"
#include "saltus/model/cells.hpp"
#include "saltus/model/hysteresis/hysteresis_description.hpp"
#include "saltus/model/mechanics/mechanics_description.hpp"
#include "saltus/model/ocp_description.hpp"
#include "saltus/model/roles.hpp"

namespace saltus::model {

/// Holds name = "expression"; location is that of the name, the expression carries its own positions.
struct NamedExpression {
  std::string name;
  expression::NodePtr expression;
  SourceLocation location;
};

/// Holds a quantity, whose bounds are expressions of parameters; absent means unbounded.
struct StateDescription {
  std::string name;
  expression::NodePtr initial;
  expression::NodePtr lower, upper;  ///< may be null
  SourceLocation location;
  bool free = false;  ///< [optimize] chooses the initial value within the bounds
};

struct ControlDescription {
  std::string name;
  expression::NodePtr initial;       ///< null means 0
  expression::NodePtr lower, upper;  ///< may be null
  SourceLocation location;
};

struct UserEventDescription {
  std::optional<std::string> name;
  expression::NodePtr when;  ///< an expression (its zeros) or a condition (its edges)
  Direction direction = Direction::both;
  AtEvent action = AtEvent::record;
  SourceLocation location;
};

/// Holds one of [[modes]]. The modes of one group share out the sign patterns of their switching functions; groups are
/// summed.
struct ModeDescription {
  std::string group;                      ///< empty: the group without a name
  expression::NodePtr when;               ///< a condition or the name `otherwise`; null with an indicator
  expression::NodePtr indicator;          ///< Stewart's form: the mode with the smallest one holds; null with `when`
  std::optional<std::string> name;        ///< only with an indicator
  std::vector<NamedExpression> dynamics;  ///< added to [dynamics]; absent states get 0
  SourceLocation location;
};

/// Holds one of [[jumps]].
struct JumpDescription {
  std::optional<std::string> name;
  JumpTrigger trigger = JumpTrigger::condition;
  expression::NodePtr when;             ///< condition or guard; null with times
  expression::NodePtr every;            ///< period, counted from the start; null without
  std::vector<expression::NodePtr> at;  ///< times
  std::vector<NamedExpression> set;     ///< state = new value
  bool at_start = false;
  expression::NodePtr priority;  ///< null means 0
  expression::NodePtr delay;     ///< null means 0
  bool persistent = true;
  std::optional<JumpValues> values;  ///< absent: at the trigger
  SourceLocation location;
};

/// Holds [tables.name]: name(e) is a function of one argument.
struct TableDescription {
  std::string name;
  std::vector<double> x, y;  ///< free of mistakes (find_mistake)
  TableKind kind = TableKind::linear;
  SourceLocation location;
};

/// Holds a piecewise constant input: value k from times[k] on, the first one before.
struct SampledInput {
  std::string name;
  std::vector<double> times, values;  ///< free of mistakes (find_mistake)
  SourceLocation location;
};

/// Holds a model file without its [simulate] table and the numerical options of [optimize]. All vectors are in the
/// order of the file.
struct Description {
  std::string file;
  std::string name;
  std::string description;
  Inclusion inclusion = Inclusion::filippov;
  std::vector<NamedExpression> parameters;
  std::vector<StateDescription> states;
  std::vector<ControlDescription> controls;
  std::vector<NamedExpression> definitions;
  std::vector<NamedExpression> switching;
  std::vector<NamedExpression> dynamics;
  std::vector<ModeDescription> modes;
  std::vector<NamedExpression> outputs;
  std::vector<UserEventDescription> events;
  std::vector<JumpDescription> jumps;
  std::vector<HysteresisDescription> hysteresis;
  std::optional<MechanicsDescription> mechanics;
  std::vector<ContactDescription> contacts;
  std::vector<TableDescription> tables;
  std::vector<NamedExpression> inputs;  ///< values of controls during a simulation, over t and parameters
  std::vector<SampledInput> sampled_inputs;
  std::vector<FreeParameterDescription> free_parameters;  ///< their initial values are in `parameters`
  std::optional<OcpDescription> optimize;
  std::optional<ClockDescription> clock;
  std::vector<expression::NodePtr> replaced;  ///< by settings: the file uses what they name
};

}  // namespace saltus::model
