// The truth check: what the event engine says of an optimised trajectory.
#pragma once

#include <functional>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

/// Holds where an element of a solution starts, in the time of OptimizedPath::times.
struct ElementStart {
  double t = 0.0;
  std::size_t interval = 0;
  std::vector<double> x;
};

/// Holds an optimised trajectory, as far as it is simulated again.
struct OptimizedPath {
  double horizon = 0.0;
  std::vector<double> parameters;  ///< all of System::p
  /// N + 1 times of the nodes in the time of the right-hand side: physical time, or numerical time where it is frozen.
  std::vector<double> times;
  std::vector<std::vector<double>> nodes;  ///< N + 1 states
  /// Where states jump at nodes: N states at the ends of intervals before that; else empty.
  std::vector<std::vector<double>> ends{};
  std::vector<ElementStart> elements{};       ///< of all intervals, those of length zero, too
  std::vector<std::vector<double>> controls;  ///< N rows, all controls of Ocp::system
  /// Of each state the largest and smallest value of the solution at nodes and stages.
  std::vector<double> state_max, state_min;
  /// The switches that the solution has, in the time of `times`, with modes before and after over the columns of the
  /// result (System::columns): those of result::Result::events.
  std::vector<result::Event> events;
};

/// Holds what is asked of the truth check.
struct VerificationWanted {
  double tolerance = 1e-3;
  /// Of every element, over all controls and the states of the result (0 x 0: corrects nothing): the controls are
  /// simulated with this feedback, too. None: they are not.
  std::vector<linalg::Matrix> gains{};
};

/// Simulates every interval from its node with its controls, then the whole horizon from the first node, and compares.
/// The amplification is that of the product of the intervals' derivatives, by central differences.
/// Definitions: docs/result-file.md, `verification`.
/// Cost: one compilation of the model, (2 n + 1) N + 1 event-driven simulations with n states.
[[nodiscard]] Expected<result::Verification> verify(const model::Ocp& ocp, const OptimizedPath& path,
                                                    const VerificationWanted& wanted,
                                                    const std::function<bool()>& is_interrupted);

}  // namespace saltus::pipeline
