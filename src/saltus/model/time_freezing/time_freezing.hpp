// Systems whose time stands still where bodies collide and where a hysteresis switches.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::model {

/// Holds numbers of [time_freezing] (docs/model-file.md).
struct FreezingNumbers {
  double a_n = 100.0, stabilisation = 0.0, transfer = 1.0;
  /// An optimisation begins with this and follows it to `stabilisation`; absent: it is fixed.
  std::optional<double> stabilisation_initial{};
  double eps_t = 1e-7;                            ///< tangential speed up to which a contact with two tangents sticks
  double correction = 0.1;                        ///< largest speed with which a held gap is corrected
  double penetration = 5e-4;                      ///< how deep an optimum may be in a contact
  double speed_lower = 1.0, speed_upper = 100.0;  ///< of time in an optimum, beside contacts and hysteresis
};

/// Returns what is wrong with them: all are positive; stabilisations and the correction may be 0.
[[nodiscard]] std::optional<Error> find_mistake(const FreezingNumbers& numbers);

/// Holds the selection of a switching function that freezing has added.
struct FrozenSelection {
  int function = -1;     ///< in System::switching; -1: none
  int orientation = +1;  ///< -1 if it is 1 less that one
};

/// Holds a contact of a frozen system. Inelastic, it is open where its gap is positive or opens, and else a force along
/// the normal stops it, or holds the gap. Elastic, a force stops it, too, and a smaller one takes
/// the depth back to 0.
struct FrozenContact {
  std::string name;
  bool is_elastic = false;
  FrozenSelection gap{};      ///< of the gap, elastic: of gap + depth
  FrozenSelection normal{};   ///< of the gap's rate; of an optimum none with restitution 1
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

}  // namespace saltus::model
