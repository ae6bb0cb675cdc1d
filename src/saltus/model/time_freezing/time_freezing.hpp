// Systems whose time stands still where bodies collide and where a hysteresis switches.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Holds the selection of a switching function that freezing has added.
struct FrozenSelection {
  int function = -1;     ///< in System::switching; -1: none
  int orientation = +1;  ///< -1 if it is 1 less that one
};

/// Holds a contact of a frozen system. Inelastic, it is open where its gap is positive or opens, and else a force along
/// the normal stops it, or holds the gap. Elastic, an oscillator of the depth takes the velocity and gives it back.
struct FrozenContact {
  std::string name;
  bool is_elastic = false;
  FrozenSelection gap{};      ///< of the gap, elastic: of gap + depth
  FrozenSelection normal{};   ///< of the gap's rate; none if elastic
  FrozenSelection tangent{};  ///< of the tangential velocity, with two tangents of its size; none without friction
  int tangents = 0;           ///< with friction
  int impulse = -1;     ///< state: sum of normal impulses, and behind it of tangential ones; -1 in an optimisation
  int gap_output = -1;  ///< output gap(name); behind it force, friction (if any) and impulse
};

struct FrozenHysteresis {
  std::string name;
  int state = 0;  ///< goes from 0 to 1 and back while time stands still
};

/// States dt/dtau = clock's rate, 1 or less; states move in physical time where it is positive [nurkanovic2022].
struct TimeFreezing {
  int clock = 0;                ///< state: physical time; the last one
  int first_hidden = 0;         ///< states from here on are in no column of a result
  int clock_rate = -1;          ///< output: d clock / d tau; the last one
  std::vector<int> velocities;  ///< states
  std::vector<FrozenContact> contacts;
  std::vector<FrozenHysteresis> hysteresis;
  int stabilisation = -1;              ///< parameter of the system: kappa, if it is followed down; -1: a constant
  double stabilisation_initial = 0.0;  ///< its value at the first relaxed problem; at last it has its parameter's
  double penetration = 0.0;            ///< gaps of an optimum are at least -penetration; infinite: whatever they are
};

/// Holds what a system with contacts or hysteresis is when it is frozen, or why it cannot be.
struct FrozenSystem {
  Expected<System> system;
};

}  // namespace saltus::model
