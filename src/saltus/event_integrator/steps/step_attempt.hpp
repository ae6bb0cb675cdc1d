// One attempt at a step: the method, its error, its dense output, and the length of the next one.
#pragma once

#include <vector>

#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/steps/method_choice.hpp"
#include "saltus/event_integrator/steps/step_memory.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/ode/step_control.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// A StepAttempt takes steps along the field of the mode from the position, which it does not move. Discrete states
/// take no part in errors.
class StepAttempt {
 public:
  StepAttempt(const IntegrationOptions& options, const model::Layout& layout, ModeField& field, const Position& here,
              const StepTolerances& tolerances);

  [[nodiscard]] ode::Stepper& stepper() { return stepper_; }
  [[nodiscard]] const ode::Stepper& stepper() const { return stepper_; }
  /// Returns the length that is tried next.
  [[nodiscard]] double length() const { return length_; }
  void set_length(double h) { length_ = h; }
  /// Begins the next step, of this length at most.
  void begin(double h) {
    length_ = h;
    was_undefined_ = false;
    doubts_ = 0;
  }
  /// Returns whether a zero that an attempt at this step shows is to be doubted: in a step half as long each time.
  [[nodiscard]] bool doubts(int most) { return doubts_ < most && ++doubts_ > 0; }
  void note_undefined() { was_undefined_ = true; }
  /// Returns whether the right-hand side was undefined in an attempt at this step.
  [[nodiscard]] bool was_undefined() const { return was_undefined_; }
  /// Takes one attempt that ends at t_new; no dense output is made yet.
  ode::Attempt take(double t_new);
  /// Makes the dense output of the last attempt, at most once; returns whether it is finite.
  bool make_dense() { return dense_is_last_ = dense_is_last_ || remake_dense(); }
  /// Does the same for an attempt that somebody else has taken with the stepper.
  bool remake_dense();
  [[nodiscard]] const ode::DenseStep& dense() const { return known_ != nullptr ? *known_ : dense_; }
  /// Returns the error norm of the last attempt over the continuous states.
  [[nodiscard]] double error_norm() const { return error_share_ * stepper_.error_norm(); }
  /// Does the same, looked at twice where the length of the step was right for another field.
  [[nodiscard]] double confirmed_error();
  /// Returns what that was of the last attempt that was no part of one before.
  [[nodiscard]] double last_error() const { return last_error_; }
  /// Returns the factor of the next length behind an attempt whose error was too large.
  [[nodiscard]] double rejected(double error) { return control_.rejected(error); }
  void follow_method() { control_.follow(stepper_.method()); }
  /// Takes the steps from here on by a method; that of the choice, or one in its place.
  void use(ode::Method method);
  /// Returns whether they are not taken by the method that steps begin with, or are not to be any more.
  [[nodiscard]] bool uses_another() const { return method_ != options_.method || method_ != choice_.method(); }
  [[nodiscard]] ode::Method method() const { return method_; }
  [[nodiscard]] MethodChoice& choice() { return choice_; }
  [[nodiscard]] const MethodChoice& choice() const { return choice_; }

  /// Notes that the last attempt, of length h, was accepted, and the position is at its end.
  void accepted(double h);
  /// Returns what the control proposes behind it.
  [[nodiscard]] double proposed(double h) { return h * control_.accepted(error_norm()); }
  /// Begins a mode: the field has become another one.
  void begin_mode();
  /// Begins the control anew behind an event; `repeats`: steps may be like ones before.
  enum class Steps { may_repeat, are_new };
  void restart_control(Steps steps);
  /// Returns a first step from the position, by the field of the continuous states alone.
  [[nodiscard]] double initial_step();
  [[nodiscard]] StepMemory& memory() { return memory_; }
  /// Returns the longest step since the control began.
  [[nodiscard]] double longest() const { return longest_; }

 private:
  auto right_hand_side() {
    return [this](double t, const double* x, double* xdot) { field_(t, x, xdot); };
  }
  double defect();
  [[nodiscard]] bool leaps() const;

  const IntegrationOptions& options_;
  ModeField& field_;
  const Position& here_;
  const StepTolerances& tolerances_;
  ode::Method method_;
  ode::Stepper stepper_;
  ode::StepControl control_;
  MethodChoice choice_;
  StepMemory memory_;
  ode::DenseStep dense_;
  const ode::DenseStep* known_ = nullptr;  ///< in its place
  bool dense_is_last_ = false;             ///< dense_ is that of the last attempt
  std::vector<std::size_t> continuous_;    ///< states that are not discrete
  double error_share_ = 1.0;               ///< the root of the mean square over the continuous states to that over all
  double length_ = 0.0;
  bool was_undefined_ = false;
  int doubts_ = 0;  ///< at this step
  double longest_ = 0.0;
  double last_error_ = 1.0;
  double last_ = 0.0;                            ///< the last step since the control began; 0 = none
  std::vector<double> x_, slope_, dense_slope_;  ///< in the middle of a step
};

}  // namespace saltus::event_integrator
