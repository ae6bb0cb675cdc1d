// A system stated in C++, in CasADi expressions.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

#include "saltus/model/description.hpp"
#include "saltus/model/recognition/condition.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::model {

/// Holds initial value and bounds (for optimisation) of a state or control, in model units.
struct Values {
  double initial = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Holds thresholds of a hysteresis, different ones, in the unit of its input, and 0 or 1 at the start.
struct HysteresisValues {
  double on = 1.0, off = 0.0;
  double initial = 0.0;
};

/// Holds what is done at an event of the user, and which crossings count.
struct EventOptions {
  std::optional<std::string> name{};  ///< event1, event2, … by position if absent
  Direction direction = Direction::both;
  AtEvent action = AtEvent::record;
};

/// Says how a jump is executed once it is triggered (docs/model-file.md, [[jumps]]).
struct JumpOptions {
  std::optional<std::string> name{};   ///< jump1, jump2, … by position if absent
  bool at_start = false;               ///< also where the condition holds at the start
  casadi::SX priority = 0.0;           ///< larger first
  casadi::SX delay = 0.0;              ///< >= 0, evaluated when triggered
  bool persistent = true;              ///< false: dropped if the condition becomes false before
  std::optional<JumpValues> values{};  ///< absent: at the trigger
};

/// States M(q) dv/dt = force - grad potential - coriolis + forces of contacts, dq/dt = v (docs/model-file.md,
/// [mechanics]).
struct Mechanics {
  std::vector<std::string> positions{}, velocities{};  ///< states, in the same order
  casadi::SX mass{};                                   ///< n x n over positions and parameters; 0 x 0: identity
  casadi::SX potential = 0.0;                          ///< over positions and parameters: its gradient is subtracted
  Coriolis coriolis = Coriolis::in_force;
  std::map<std::string, casadi::SX> force{};  ///< by velocity; absent: 0
  std::vector<DrawnShape> draw{};             ///< of the bodies, over positions and parameters; for the report
};

/// States gap >= 0, with friction along a tangent, or in the plane of two (docs/model-file.md, [[contacts]]).
struct ContactOptions {
  std::map<std::string, casadi::SX> tangent{};         ///< by position; empty: frictionless
  casadi::SX friction = 0.0;                           ///< >= 0, over parameters
  casadi::SX restitution = 0.0;                        ///< in [0, 1], over parameters
  std::map<std::string, casadi::SX> second_tangent{};  ///< by position; empty: slip has one direction
};

/// Builds a System step by step; the names, the rules and the errors are those of the model file.
///
///   Builder model("stick-slip");
///   const SX mu = model.parameter("mu", 0.8), q = model.state("q", {0.04}), v = model.state("v", {-0.01});
///   const SX slip = model.switching("slip", v - 0.2);
///   model.dynamics("q", v);
///   model.dynamics("v", -q - mu * model.sign(slip));
///   Expected<System> system = model.build();
///
/// All expressions are scalar and made of the symbols this builder returned. Nonsmooth functions must be the builder's:
/// CasADi's own (sign, fabs, fmin, if_else, comparisons) would hide their switches and are refused by build().
/// Functions never throw: the first mistake is kept and returned by build(), and what follows it is ignored.
class Builder {
 public:
  explicit Builder(std::string name);
  ~Builder();
  Builder(Builder&&) noexcept;
  Builder& operator=(Builder&&) noexcept;

  void set_description(std::string text);
  void set_inclusion(Inclusion inclusion);

  /// Returns the time t.
  [[nodiscard]] casadi::SX time() const;
  /// @param value  finite; shared switching functions, folding and kinks are decided for it
  casadi::SX parameter(const std::string& name, double value);
  casadi::SX state(const std::string& name, const Values& values);
  /// Adds a state that changes by jumps only: its rate is 0, and a comparison of such states is decided as written
  /// where both sides are equal.
  casadi::SX discrete_state(const std::string& name, double initial);
  /// Adds a name that is 0 or 1: a discrete state that becomes 1 where `input` rises through `on` and 0 where it falls
  /// through `off` (on > off), or the other way round (on < off). A jump of the same name changes it. Where the input
  /// is beyond a threshold at the start, the side it is on holds, with a warning.
  /// @param input  over states and parameters
  casadi::SX hysteresis(const std::string& name, const casadi::SX& input, const HysteresisValues& values);
  casadi::SX control(const std::string& name, const Values& values);
  /// Declares the switching function psi under a name and returns psi itself.
  casadi::SX switching(const std::string& name, const casadi::SX& psi);

  /// Returns step(e) = alpha, in [0, 1] on e = 0; `name` for the switching function, by default the text of e.
  casadi::SX step(const casadi::SX& e, const std::string& name = "");
  casadi::SX sign(const casadi::SX& e, const std::string& name = "");
  casadi::SX abs(const casadi::SX& e, const std::string& name = "");
  /// Adds the switching function a - b.
  casadi::SX max(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");
  casadi::SX min(const casadi::SX& a, const casadi::SX& b, const std::string& name = "");
  /// Returns a where the condition holds, else b; NaN of the branch not taken does not spread.
  casadi::SX if_(const Condition& condition, const casadi::SX& a, const casadi::SX& b);

  /// Returns the largest integer not above e, an expression of time and parameters: right-continuous, it jumps there.
  casadi::SX floor(const casadi::SX& e);
  /// Returns e - m floor(e / m), in [0, m) for m > 0; m a constant other than 0.
  casadi::SX mod(const casadi::SX& e, const casadi::SX& m);
  /// Declares a table under a name and returns it as a function of one argument, any expression of the model:
  ///
  ///   const auto road = model.table("road", {0, 1, 2}, {0, 0.1, 0});
  ///   model.dynamics("z", road(x) - z);
  ///
  /// Constant outside the points. Every cell between two of them is smooth for the integrators, so its cost does not
  /// depend on their number.
  /// @param x  ascending; y one value each; 2 to 10^6 finite points, cubic at least 4
  /// @return the function; valid as long as this builder
  std::function<casadi::SX(const casadi::SX&)> table(const std::string& name, const std::vector<double>& x,
                                                     const std::vector<double>& y, TableKind kind = TableKind::linear);

  /// Sets d state / dt; at most once for every state, and exactly once for one that no mode mentions.
  void dynamics(const std::string& state, const casadi::SX& rate);
  /// Gives positions and velocities their dynamics; once at most. The result has the output `energy`.
  void mechanics(const Mechanics& mechanics);
  /// Adds bodies that do not pass through each other: gap over positions, parameters and time, >= 0 at the start. The
  /// result has the outputs gap(name), force(name), friction(name), impulse(name).
  void contact(const std::string& name, const casadi::SX& gap, const ContactOptions& options = {});
  /// Says how time is frozen at contacts and hysteresis for Method::fesd and OcpBuilder, which have no events there.
  void time_freezing(const FreezingNumbers& numbers);
  /// Adds one mode of a group: where the condition holds, the rates are added to those of dynamics() and of the modes
  /// of other groups; a state that is not among them gets 0. The modes of a group cover every sign pattern of their
  /// switching functions exactly once.
  void mode(const Condition& when, const std::map<std::string, casadi::SX>& rates, const std::string& group = "");
  /// Adds one mode of a group by indicator: it holds where its indicator is the smallest of the group (Stewart's form);
  /// the fields of regions with equal indicators mix. Without a name it is mode1, mode2, … by its position.
  void region(const casadi::SX& indicator, const std::map<std::string, casadi::SX>& rates, const std::string& name = "",
              const std::string& group = "");
  /// Adds the mode that holds where no other one of the group does.
  void otherwise(const std::map<std::string, casadi::SX>& rates, const std::string& group = "");
  void output(const std::string& name, const casadi::SX& expression);
  /// Adds zeros of an expression, or edges of a condition.
  void event(const casadi::SX& expression, const EventOptions& options = {});
  void event(const Condition& condition, const EventOptions& options = {});
  /// Gives the states of `set` their new values, all at once, when the condition becomes true.
  void jump(const Condition& when, const std::map<std::string, casadi::SX>& set, const JumpOptions& options = {});
  /// Does so when the guard has passed 0 in the given direction.
  void jump(const casadi::SX& guard, Direction direction, const std::map<std::string, casadi::SX>& set,
            const JumpOptions& options = {});
  /// Does so at times in ascending order.
  void jump_at(const std::vector<double>& times, const std::map<std::string, casadi::SX>& set,
               const JumpOptions& options = {});
  /// Does so at start + k period, k = 1, 2, …
  void jump_every(double period, const std::map<std::string, casadi::SX>& set, const JumpOptions& options = {});
  /// Sets the control during a simulation, an expression of time and parameters; its initial value otherwise.
  void input(const std::string& control, const casadi::SX& expression);
  /// Sets the same, piecewise constant: values[k] from times[k] on, the first one before.
  /// @param times  ascending; one finite value each
  void input(const std::string& control, const std::vector<double>& times, const std::vector<double>& values);

  /// @return the system, or the first mistake. May be called again after more has been stated.
  [[nodiscard]] Expected<System> build();

 private:
  friend class OcpBuilder;  // takes forms that a simulation does not
  struct Parts;
  // Keeps the recognition of nonsmooth terms out of the header.
  std::unique_ptr<Parts> parts_;
};

}  // namespace saltus::model
