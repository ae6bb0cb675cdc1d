// An optimal control problem with contacts or hysteresis, by time stepping: coarse, and easy to solve.
#pragma once

#include <memory>
#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::time_stepping {

/// Holds a motion and its controls in the user's quantities.
struct Motion {
  double horizon = 0.0;
  std::vector<double> parameters;             ///< all of System::p
  std::vector<std::vector<double>> controls;  ///< row per interval, all controls
  std::vector<double> initial_state;
  std::vector<std::vector<double>> states;  ///< row per end of a step
};

/// Returns where steps end, as fractions of the horizon: equally many in each interval.
[[nodiscard]] std::vector<double> ends_of_steps(int intervals);

/// States a problem with contacts whose steps are implicit Euler's, with impulses p >= 0 and friction b over a step h:
///   M (v' - v) = h F + N p + T b,  q' = q + h v',  0 <= p _|_ gap(q') >= 0,
///   0 <= b+- _|_ s +- T'v' >= 0,  0 <= s _|_ mu p - sum b >= 0
/// [stewart1996]. Collisions need no elements of their own; the error is O(h). Of an impulse p a contact with
/// restitution e gives e p back two steps later: Poisson's law. A hysteresis w that its jump changes to s where g > 0
/// is
///   w' = w + alpha(g) (s - w)
/// with g at the end of a step that is done with w. From a threshold on it may stay between 0 and 1, which no motion
/// does.
class SteppedOcp {
 public:
  /// Returns nothing where time is not frozen, or where there is anything that is not stated so: other jumps, cells,
  /// measurements, complementarities of the user's.
  /// Cost: linear in the number of steps.
  /// @param is_held  a free horizon stays what is guessed
  [[nodiscard]] static std::unique_ptr<SteppedOcp> make(const model::Ocp& ocp, int intervals, const Motion& guess,
                                                        bool is_held = false);
  ~SteppedOcp();

  [[nodiscard]] mpcc::Problem& problem() const { return *problem_; }
  /// Returns the start of the problem with other states, rows as Motion::states.
  [[nodiscard]] linalg::Vector start_at(const std::vector<std::vector<double>>& states) const;
  [[nodiscard]] Motion read(mpcc::ConstVectorView w) const;

 private:
  friend class Builder;
  SteppedOcp() = default;
  [[nodiscard]] std::vector<double> values(mpcc::ConstVectorView w, const std::vector<int>& places) const;

  std::unique_ptr<mpcc::Problem> problem_;
  Motion motion_;     ///< what is no variable
  int horizon_ = -1;  ///< variables, -1 where they are none
  std::vector<int> parameters_, initial_state_;
  std::vector<std::vector<int>> controls_, states_;
};

}  // namespace saltus::time_stepping
