// By which method steps are taken: the one that was named, or the one that fits.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/ode/step_control.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/result/statistics.hpp"

namespace saltus::event_integrator {

/// Returns the explicit method to begin with: dopri5 down to rtol = 1e-6, where dop853 takes about as many evaluations
/// in modes that are not affine; below, taylor, which is dop853 there, or for many states, of which a switch moves few,
/// dop853.
[[nodiscard]] ode::Method first_method(std::size_t states, const ode::Tolerances& tolerances);

/// A MethodChoice watches accepted steps. An explicit method that stability limits gives way to a Radau method, whose
/// order follows from the contraction of Newton's iteration: up where it is fast, down where it is slow. A Radau method
/// gives way where explicit steps could be twice as long. Each mode has its own choice, which is kept for its next
/// visit. A method that was named stays; where stability limits it, that is noted. Cost: a few operations a step; after
/// a switch O(n_psi), once any mode was stiff.
class MethodChoice {
 public:
  MethodChoice(const IntegrationOptions& options, const Position& here);

  /// Returns the method of the next step.
  [[nodiscard]] ode::Method method() const { return now_.method; }
  /// Returns when a method that was named was first limited by stability.
  [[nodiscard]] std::optional<double> stiff_at() const { return stiff_at_; }

  /// Goes on in the mode here, whose right-hand side is another one.
  void begin_mode();
  /// Counts a step of length h, accepted or up to an event.
  void count(ode::Method method, double h);
  /// Notes an accepted step that ends here.
  /// @param watched  whether its length says something: it is not as long as it may be
  void accepted(ode::Stepper& stepper, const ode::Tolerances& tolerances, bool watched);
  /// Notes an attempt in which a Radau method found no stages. Where that goes on the mode is left to the explicit
  /// method; for good, but where the right-hand side is undefined, which is so at a place.
  void failed(ode::Stages stages);
  /// Returns where that was first so for good.
  struct Failure {
    double t;
    ode::Method method;
    ode::Stages stages;
  };
  [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }
  /// Returns how many steps were taken by which method, and how much time passed in them; empty if it was named.
  [[nodiscard]] std::vector<result::IntegratorUse> uses() const;

 private:
  struct State {
    ode::Method method = ode::Method::dopri5;
    bool may_be_implicit = true;
  };
  struct Known {
    std::vector<int> mode;
    State state;
  };
  void forget_steps();
  void change_to(ode::Method method);
  void look_at_explicit(const ode::Stepper& stepper, const ode::Tolerances& tolerances);
  void look_at_implicit(ode::Stepper& stepper);
  [[nodiscard]] std::vector<Known>::iterator find_mode();

  static constexpr std::size_t capacity = 32;
  bool chooses_;
  const Position& here_;
  ode::Method first_;
  State now_;
  std::vector<Known> known_;  ///< modes that were left by another method than the first, at most `capacity`
  std::size_t next_ = 0;      ///< of these, to be overwritten
  ode::StiffnessWatch stiffness_;
  int short_enough_ = 0;  ///< implicit steps in a row that an explicit method could take
  int age_ = 0;           ///< steps since the order was changed
  int failures_ = 0;      ///< in a row
  std::optional<double> stiff_at_;
  std::optional<Failure> failure_;
  std::array<result::IntegratorUse, ode::methods> uses_;
};

}  // namespace saltus::event_integrator
