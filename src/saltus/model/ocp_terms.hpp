// What an optimal control problem minimises and constrains, by numbers of the outputs of its system.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/model/ocp_description.hpp"

namespace saltus::model {

struct System;

/// States lower <= y_output <= upper, y the outputs of Ocp::system; one of both may be infinite.
struct OcpConstraint {
  std::string name;  ///< as written
  int output = 0;
  double lower = 0.0, upper = 0.0;
  ConstraintNorm norm = ConstraintNorm::hard;
  double penalty = 0.0;
  bool is_slack = false;   ///< of a kink of controls: holds with every control, or at every stage; in no result
  bool at_stages = false;  ///< of a slack: its slack is one of `stage_slacks`
};

/// States r'W r, r = y_of - reference.
struct OcpLeastSquares {
  std::vector<int> of;
  std::vector<int> reference;  ///< outputs of t and p; empty: 0, or samples
  linalg::Matrix samples;      ///< one row per interval, or per time; 0 x 0 without
  std::vector<double> times;   ///< of measurements, ascending: at CostPoints::times, where it is summed up
  linalg::Matrix weight;       ///< symmetric
  CostPoints at = CostPoints::intervals;
  /// Returns how many numbers of it every interval has.
  [[nodiscard]] linalg::Index samples_per_interval() const { return times.empty() ? samples.cols() : 0; }
};

/// States p_parameter = x_state(from).
struct OcpInitialValue {
  int state = 0, parameter = 0;
};

/// Holds what initial_guess says of one quantity.
struct OcpGuess {
  enum class Kind { state, control, parameter };
  Kind kind = Kind::state;
  int index = 0;
  int output = 0;  ///< of t and p
};

struct OcpGuesses {
  std::vector<OcpGuess> list;
  /// Whose outputs they are, since their kinks are no switches of the problem; null: the problem's system.
  std::shared_ptr<const System> system;
};

struct OcpHorizon {
  bool free = false;
  double value = 1.0;  ///< > 0; the guess of a free one
  double lower = 0.0, upper = 0.0;
  double time_weight = 0.0;  ///< w, of w T in the objective; 0: none
};

/// Holds the time frozen by hand, or for contacts and hysteresis: x_state is physical time, dx_state / dtau its speed.
struct OcpClock {
  int state = 0;
  double speed_lower = 1.0, speed_upper = 1.0;
};

}  // namespace saltus::model
