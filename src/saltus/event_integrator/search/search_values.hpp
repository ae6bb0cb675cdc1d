// What the event search knows about its functions beside the mode: values, levels, bounds of the states.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/search/affine_forms.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Holds one of the regions that meet at the sliding surfaces inside nested functions.
struct NestedCorner {
  std::vector<double> alpha;  ///< its selections
  std::vector<double> phi;
  evaluation::AffineRows rows;
};

/// Holds values and scales of all functions of the kernel, and their values in the regions of nested ones.
struct KernelValues {
  std::vector<double> phi, magnitude, slope;
  std::vector<double> middle, radius;  ///< over a step, of those that are not affine
  std::vector<double> radii;           ///< of t and the states over it
  std::vector<double> pressure;        ///< on each guard that is held
  std::vector<NestedCorner> corners;   ///< of the mode
};

/// Holds, for each function, its rounding, and what the tolerances leave of it, which is at least that.
struct FunctionLevels {
  std::vector<double> noise, accuracy;

  void reset(std::size_t functions);
  /// Sets the levels; those that are not finite are 0.
  void set(std::size_t function, double rounding, double wanted);
};

/// Holds surfaces whose mode is another one than before, ascending, and by surface which exits may have changed with
/// them.
struct TurnedSurfaces {
  std::vector<std::size_t> surfaces;
  std::vector<bool> beside;
};

/// Holds bounds of the states over a step.
struct StepRange {
  std::vector<double> low, high;
  std::vector<double> wide_low, wide_high;  ///< around it
  StepBounds bounds;
  bool near_is_known = false;  ///< which curved functions may vanish within them
  bool known = false;          ///< `bounds` are those of the dense output that is made next

  void resize(std::size_t states);
  /// Reads the bounds of the last attempt; false where there are none.
  [[nodiscard]] bool read(const ode::Stepper& stepper);
  void read(const ode::DenseStep& step);
  /// Returns the bounds, wider by as much as the step moves, or by a thousand tolerances; valid until the next call.
  [[nodiscard]] StepBounds widened(const ode::Tolerances& tolerances);
};

}  // namespace saltus::event_integrator
