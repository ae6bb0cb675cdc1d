// [[contacts]] and [[hysteresis]] become auxiliary dynamics in which the clock stands still.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/hysteresis/hysteresis_internal.hpp"
#include "saltus/model/mechanics/contacts_internal.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::model {

enum class FrozenFor { simulation, optimisation };

/// Holds a rate that is added to that of a state.
struct AddedRate {
  int state = 0;
  casadi::SX rate;
};

/// Holds the input, scaled to 0 at `off` and 1 at `on`, and the state.
struct HysteresisPlane {
  std::string name;
  casadi::SX scaled, value;
  int state = 0;
};

/// Holds what is gathered on the way from a description to a frozen system.
struct FreezingPlan {
  FrozenFor purpose = FrozenFor::simulation;
  FreezingNumbers numbers{};
  TimeFreezing made{};
  SXElem numerical_time{};
  std::vector<double> restitution{};  ///< by contact
  std::vector<int> depth{};           ///< state of an elastic contact, else -1
  /// Instead of `waits`: the one hysteresis of an optimisation by regions in the plane of its input and state.
  std::optional<HysteresisPlane> plane{};
  bool takes_plane = false;
  casadi::SX waits = 1.0;          ///< 1 unless a hysteresis switches
  casadi::SX moves = 1.0;          ///< 1 unless a contact is closed
  casadi::SX stabilisation = 0.0;  ///< kappa: a number, or a parameter
  std::vector<AddedRate> added{};
  std::vector<std::pair<SXElem, FrozenSelection*>> selections{};  ///< to be found in the system
};

/// Holds what the hidden states of a contact depend on.
struct ContactToFreeze {
  std::string name;
  double restitution = 0.0;
  bool in_plane = false;
};

/// Appends the hidden states of contacts behind those of hysteresis, which the plan has, and the parameter of a
/// stabilisation that is followed down.
void declare_hidden(Recognition& recognition, Statement& statement, const std::vector<ContactToFreeze>& contacts,
                    FreezingPlan& plan);

/// Returns the numbers of [time_freezing], defaults for those that are not stated. All names are declared.
[[nodiscard]] Expected<FreezingNumbers> freezing_numbers(const Description& description, ModelScope& scope);

/// Appends the states of the plan: one for every hysteresis, then what is hidden, the clock last; `t` is the clock from
/// now on. The values of parameters are known.
[[nodiscard]] std::optional<Error> declare_frozen(const Description& description, ModelScope& scope,
                                                  Recognition& recognition, Statement& statement, FreezingPlan& plan);

/// Takes one hysteresis into the plan: its state goes to 1 where the input is beyond `on`, and to 0 beyond `off`.
[[nodiscard]] std::optional<Error> freeze_hysteresis(Recognition& recognition, Statement& statement, int state,
                                                     const SXElem& input, const HysteresisThresholds& thresholds,
                                                     FreezingPlan& plan);

/// Takes the contacts into the plan and appends their outputs.
/// @return the force without contacts, which is all there is in the free mode
[[nodiscard]] Expected<casadi::SX> freeze_contacts(Recognition& recognition, Statement& statement,
                                                   const std::vector<ContactStatement>& contacts,
                                                   const MotionWithoutContacts& motion, FreezingPlan& plan);

/// Adds right-hand sides of a plan with a plane: regions between which the state waits at 0 or 1 by sliding.
void freeze_in_plane(Statement& statement, const FreezingPlan& plan);

/// Is called when all right-hand sides are there: makes them those of numerical time.
void freeze_rates(Statement& statement, const FreezingPlan& plan);

/// Finds the numbers of selections in the system that was made of the plan.
void find_selections(const System& system, FreezingPlan& plan);

}  // namespace saltus::model
